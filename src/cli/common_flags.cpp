#include "cli/common_flags.h"

#include "cli/values.h"

namespace castray::cli {

void CommonFlags::add_to(Arguments& arguments) {
  arguments.add_switch("-q,--quiet", quiet, "no progress and no warnings on stderr");
  arguments.add_switch("-v,--verbose", verbose, "say more");
  if (arguments.has("--threads")) return;
  // One thread is enough for most commands; scripts may give the flag to all alike.
  arguments
      .add_text("-t,--threads", "N", "at most so many threads",
                [this](const std::string& text) {
                  threads = static_cast<int>(parse_whole("threads", text, 1, 4096));
                })
      .hidden();
}

}  // namespace castray::cli
