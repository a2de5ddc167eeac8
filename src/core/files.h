#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace castray {

/// What a file's name ends in, with the dot, in lower case: ".obj".
std::string suffix_of(const std::filesystem::path& file);

/// The text as part of a file's name: all but letters, digits, '-', '_' and '.' is '_'.
std::string as_file_name(std::string text);

/// All bytes of a file. Throws InputError that says why it cannot be read.
std::string read_file(const std::filesystem::path& file);

/// The first bytes of a file, up to the `end` that is the first at or behind `at_least`, or all of them.
/// Throws InputError that says why it cannot be read.
std::string read_head(const std::filesystem::path& file, std::size_t at_least, char end);

/// Whether a file's name stands for the standard output: "-", "/dev/stdout", or "FORMAT:-", as in "exr:-".
bool is_standard_output(const std::filesystem::path& file);

/// Writes what `write` puts into the stream to a temporary file beside `file`, waits until it is on the
/// disk, then renames it, and waits for that too, so that `file` is at any time the old one or the new one. A
/// symbolic link is followed; what is not a regular file (a device, a pipe, the standard output) is written
/// to directly, once all bytes are known; a named pipe that nobody reads is waited for, as by cp. Throws
/// InputError, with `file` untouched and no temporary file left, if anything fails or `write` throws.
void write_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);
void write_file(const std::filesystem::path& file, std::string_view bytes);

/// The same; the file that was there is kept as `previous`, in the same folder. At any time one of the two is
/// there and whole.
void write_file_keeping(const std::filesystem::path& file, const std::filesystem::path& previous,
                        const std::function<void(std::ostream&)>& write);

/// Throws the InputError that `write_file` would, as far as that can be known without writing: the folder is
/// missing or not writable, the target is a folder or write-protected.
void check_writable(const std::filesystem::path& file);

}  // namespace castray
