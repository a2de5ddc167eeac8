#include "cli/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>

#include "castray/error.h"
#include "cli/values.h"
#include "core/text.h"

namespace castray::cli {

namespace {

/// Where an engine tells its tasks which they are. Null: it does not.
struct TaskVariables {
  const char* index;
  const char* count;
  const char* least = nullptr;  ///< the first index of the array
  const char* step = nullptr;   ///< between indices
};

constexpr TaskVariables engines[] = {
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP"},
    {"JOB_COMPLETION_INDEX", nullptr},
    {"AWS_BATCH_JOB_ARRAY_INDEX", nullptr},
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
    {"PMI_RANK", "PMI_SIZE"},
    {"SLURM_PROCID", "SLURM_NTASKS"},
};

std::optional<std::uint64_t> number_in(const char* variable) {
  const char* value = variable ? std::getenv(variable) : nullptr;
  if (!value) return std::nullopt;
  return parse_whole(std::string("part auto: ") + variable, value, 0,
                     std::numeric_limits<std::uint32_t>::max());
}

const TaskVariables& engine_of(const std::string& flag) {
  for (const TaskVariables& engine : engines)
    if (std::getenv(engine.index)) return engine;
  throw InputError("--" + flag +
                   " auto: no Slurm array, Kubernetes index, AWS Batch array or MPI rank is in the "
                   "environment; give I/N");
}

Part automatic_part(const std::string& flag, const std::optional<std::uint64_t>& count) {
  const TaskVariables& engine = engine_of(flag);
  const std::uint64_t index = *number_in(engine.index);
  if (count) return {index, *count};
  const std::optional<std::uint64_t> all = number_in(engine.count);
  if (!all)
    throw InputError(
        fmt::format("--{} auto: {} is not told how many parts there are; give auto/N", flag, engine.index));
  const std::uint64_t least = number_in(engine.least).value_or(0);
  const std::uint64_t step = std::max<std::uint64_t>(number_in(engine.step).value_or(1), 1);
  return {(index - std::min(least, index)) / step, *all};
}

}  // namespace

Part parse_part(const std::string& flag, const std::string& text) {
  const auto words = split(text, '/');
  const auto number = [&](const std::string& word, std::uint64_t least) {
    return parse_whole(flag, word, least, std::numeric_limits<std::uint32_t>::max());
  };
  Part part;
  if (words.size() <= 2 && words[0] == "auto")
    part = automatic_part(flag, words.size() == 2 ? std::optional(number(words[1], 1)) : std::nullopt);
  else if (words.size() == 2)
    part = {number(words[0], 0), number(words[1], 1)};
  else
    throw InputError("--" + flag + " '" + printable(text) + "': must be I/N, as in 0/4, auto, or auto/N");
  if (part.index >= part.count)
    throw InputError(fmt::format("--{} {}/{}: parts are counted from 0: 0/{} to {}/{}", flag, part.index,
                                 part.count, part.count, part.count - 1, part.count));
  return part;
}

SampleRange range_of(const Part& part, const SampleRange& all) {
  if (part.count > all.count)
    throw InputError(fmt::format("--part {}/{}: there are {} samples; {} parts at most", part.index,
                                 part.count, all.count, all.count));
  const auto begin_of = [&](std::uint64_t index) {
    return all.count * index / part.count;
  };  // both have 32 bits
  return {all.first + begin_of(part.index), begin_of(part.index + 1) - begin_of(part.index)};
}

std::filesystem::path name_of(const Part& part, const std::filesystem::path& file) {
  std::string name = file.string();
  const std::string number = fmt::format("{:0{}}", part.index, fmt::formatted_size("{}", part.count - 1));
  constexpr std::string_view place = "{part}";
  for (std::size_t at; (at = name.find(place)) != std::string::npos;) name.replace(at, place.size(), number);
  return name;
}

}  // namespace castray::cli
