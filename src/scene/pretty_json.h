#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace castray {

/// JSON for people: what fits in a line is in one; numbers have as few digits as tell them apart.
std::string pretty_json(const nlohmann::ordered_json& value);

}  // namespace castray
