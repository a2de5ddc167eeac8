#pragma once

namespace castray::cli {

/// compare_page.html, in which @DATA@ stands for the page's data.
extern const char* const compare_page;

}  // namespace castray::cli
