#pragma once

#include <string>
#include <vector>

#include "castray/error.h"
#include "castray/render.h"
#include "wavefront/choose_kernel.h"

namespace castray::test {

/// A way to render: integrator, instruction set, accelerator, shared or plain paths.
struct Way {
  std::string name;
  RenderOptions options;
};

/// Each instruction set of this processor.
inline std::vector<std::string> instruction_sets() {
  std::vector<std::string> sets;
  for (const char* name : {"scalar", "sse4", "avx2", "avx512"}) {
    try {
      sets.emplace_back(choose_kernel(name).name);
    } catch (const InputError&) {  // this processor does not have it
    }
  }
  return sets;
}

/// Whether the set multiplies and adds in one rounding: sets that do give the same bytes, as do those that do
/// not.
inline bool has_fma(const std::string& set) { return set == "avx2" || set == "avx512"; }

/// Of each arithmetic, with fused multiply-add and without, the widest instruction set: enough for tests of
/// means where check_same_bytes says that the others give its bytes.
inline std::vector<std::string> arithmetics() {
  std::vector<std::string> widest;
  for (const std::string& set : instruction_sets()) {
    if (widest.empty() || has_fma(set) != has_fma(widest.back())) widest.emplace_back();
    widest.back() = set;
  }
  return widest;
}

/// The reference in both precisions, and the wavefront with each of the instruction sets, over list and tree,
/// with shared and plain paths, all with the size and samples of `options`.
inline std::vector<Way> every_way(const RenderOptions& options,
                                  const std::vector<std::string>& sets = instruction_sets()) {
  std::vector<Way> ways;
  for (const Precision precision : {Precision::float32, Precision::float64}) {
    ways.push_back({precision == Precision::float32 ? "reference, float" : "reference, double", options});
    ways.back().options.integrator = Integrator::reference;
    ways.back().options.precision = precision;
  }
  for (const std::string& set : sets)
    for (const AccelKind accel : {AccelKind::list, AccelKind::bvh})
      for (const bool shared : {true, false}) {
        ways.push_back(
            {set + (accel == AccelKind::list ? ", list" : ", tree") + (shared ? ", shared" : ", plain"),
             options});
        ways.back().options.isa = set;
        ways.back().options.accel = accel;
        ways.back().options.reuse.automatic = shared;
      }
  return ways;
}

}  // namespace castray::test
