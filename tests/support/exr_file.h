#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

/// A part of an EXR file for tests: float channels of one value each, over `data`.
struct TestPart {
  std::map<std::string, float> channels;
  Imath::Box2i display{{0, 0}, {3, 2}}, data = display;
  std::string name = "";
  bool wide_gamut = false;  ///< says that its primaries are those of ACES
};

inline void write_exr_parts(const std::filesystem::path& file, const std::vector<TestPart>& parts) {
  std::vector<Imf::Header> headers;
  for (const TestPart& part : parts) {
    Imf::Header header(part.display, part.data);
    header.setType(Imf::SCANLINEIMAGE);
    if (!part.name.empty()) header.setName(part.name);
    if (part.wide_gamut)
      Imf::addChromaticities(header, {{0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f}, {0.3217f, 0.3377f}});
    for (const auto& [name, value] : part.channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    headers.push_back(header);
  }
  Imf::MultiPartOutputFile out(file.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Imath::Box2i& data = parts[i].data;
    const auto width = static_cast<std::size_t>(data.max.x - data.min.x + 1);
    std::vector<std::vector<float>> rows;
    Imf::FrameBuffer frame;
    for (const auto& [name, value] : parts[i].channels) {
      rows.emplace_back(width, value);
      auto* base = reinterpret_cast<char*>(rows.back().data() - data.min.x);
      frame.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), 0));
    }
    Imf::OutputPart part(out, static_cast<int>(i));
    part.setFrameBuffer(frame);
    part.writePixels(data.max.y - data.min.y + 1);
  }
}
