// Foreign text, such as frame names and values of files, in a form for logs and error messages.
#pragma once

#include <cstddef>
#include <string>

namespace racecar_mcl {

constexpr std::size_t kMaxPrintedLength = 64;  ///< characters of a frame, topic or value

/// The text in printable ASCII: other bytes are escaped as in C strings. Longer texts are cut and
/// end in "...".
std::string printable(const std::string& text, std::size_t max_length = kMaxPrintedLength);

/// The text without control characters, which are escaped as by `printable`; its length and other
/// bytes, such as UTF-8, are kept.
std::string withoutControlCharacters(const std::string& text);

}  // namespace racecar_mcl
