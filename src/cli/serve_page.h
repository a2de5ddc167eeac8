#pragma once

namespace castray::cli {

/// serve_page.html, in which @DATA@ stands for the page's data.
extern const char* const serve_page;

}  // namespace castray::cli
