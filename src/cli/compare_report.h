#pragma once

#include <string>
#include <vector>

#include "cli/comparison.h"

namespace castray::cli {

/// For people: a table of metrics, limits and the verdict; for several images a line each, and `all_tables`.
std::string text_report(const std::vector<Comparison>& comparisons, bool all_tables);

/// One comparison: the object that docs/compare.md describes; of folders: {"pass", "comparisons": [...]}.
std::string json_report(const std::vector<Comparison>& comparisons, bool folders);

/// JUnit's XML, as CI servers read it: a test case an image.
std::string junit_report(const std::vector<Comparison>& comparisons);

/// A self-contained web page, failures first. Needs no network. `arguments` and `flags` are those of the
/// command that repeats the comparison; the flags are those of each single one too.
std::string html_report(const std::vector<Comparison>& comparisons, const std::string& arguments,
                        const std::string& flags);

/// The failed checks, or the error, in one line; empty where all is well.
std::string complaint(const Comparison& c);

/// What belongs to a metric's value: its unit, or where it was found.
std::string metric_detail(const ErrorMetrics& errors, const std::string& metric);

}  // namespace castray::cli
