#include "scene/sun_position.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <regex>

namespace castray {

namespace {

constexpr double degree = std::numbers::pi / 180;

double turned(double degrees) { return degrees - 360 * std::floor(degrees / 360); }

}  // namespace

SunPosition sun_position(double days, double latitude, double longitude) {
  const double mean_longitude = turned(280.460 + 0.9856474 * days);
  const double anomaly = turned(357.528 + 0.9856003 * days) * degree;
  const double ecliptic =
      (mean_longitude + 1.915 * std::sin(anomaly) + 0.020 * std::sin(2 * anomaly)) * degree;
  const double obliquity = (23.439 - 0.0000004 * days) * degree;
  const double right_ascension = std::atan2(std::cos(obliquity) * std::sin(ecliptic), std::cos(ecliptic));
  const double sin_declination = std::sin(obliquity) * std::sin(ecliptic),
               cos_declination = std::sqrt(1 - sin_declination * sin_declination);
  const double sidereal = 280.46062 + 360.98564737 * days;  // of Greenwich
  const double hour_angle = turned(sidereal + longitude) * degree - right_ascension;
  const double sin_latitude = std::sin(latitude * degree), cos_latitude = std::cos(latitude * degree);
  const double east = -cos_declination * std::sin(hour_angle);
  const double towards_pole = cos_declination * std::cos(hour_angle);
  const double north = sin_declination * cos_latitude - towards_pole * sin_latitude;
  const double up = sin_declination * sin_latitude + towards_pole * cos_latitude;
  return {std::atan2(up, std::hypot(east, north)) / degree, turned(std::atan2(east, north) / degree)};
}

double refraction(double elevation) {
  if (elevation < -1) return 0;
  return 1.02 / 60 / std::tan((elevation + 10.3 / (elevation + 5.11)) * degree);
}

std::optional<double> days_of(const std::string& time) {
  static const std::regex form(
      R"((\d{4})-(\d\d)-(\d\d)T(\d\d):(\d\d)(?::(\d\d(?:\.\d+)?))?(?:Z|([+-])(\d\d):(\d\d)))");
  std::smatch part;
  if (!std::regex_match(time, part, form)) return {};
  const auto number = [&part](std::size_t i) { return part[i].matched ? std::stod(part[i]) : 0.; };
  using namespace std::chrono;
  const year_month_day date{year(static_cast<int>(number(1))), month(static_cast<unsigned>(number(2))),
                            day(static_cast<unsigned>(number(3)))};
  if (!date.ok() || number(1) < 1900 || number(1) > 2100 || number(4) > 24 || number(5) > 59 ||
      number(6) >= 61 || number(8) > 23 || number(9) > 59)
    return {};
  const auto whole_days = (sys_days(date) - sys_days(2000y / January / 1)).count();
  const double offset = (number(8) + number(9) / 60) * (part[7] == "-" ? -1 : 1);
  const double hours = number(4) + number(5) / 60 + number(6) / 3600 - offset;
  return static_cast<double>(whole_days) + (hours - 12) / 24;
}

}  // namespace castray
