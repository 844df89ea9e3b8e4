// SPDX-License-Identifier: Apache-2.0
// Long lists of numbers as text, in parallel: the ASCII form of VTK files.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "base/file/file.h"
#include "data/array.h"

namespace sg::vtk {

/// Where the numbers end, and the first word that is not a number.
struct NumbersEnd {
  size_t parsed = 0;           ///< numbers read, `count` when all is well
  const char* next = nullptr;  ///< behind the last number read
  const char* bad = nullptr;   ///< a word that is not a number of that type; null when the text ended too early
};

/// Reads `count` numbers between white space into `out` (count elements of `type`). Accepts what VTK, C and Windows print
/// ("1e3", "+2", "nan", "-inf", "1.#QNAN"). The text is cut at multiples of a fixed size, so threads do not matter.
NumbersEnd parse_numbers(std::string_view text, ElementType type, size_t count, std::byte* out);

/// White space as VTK's readers take it.
inline bool blank(char c) { return static_cast<unsigned char>(c) <= ' '; }

/// Words in the text.
size_t count_words(std::string_view text);

/// The numbers [begin, end) as text, `per_line` on a line, in the shortest form that reads back as the same number.
std::string format_numbers(const Array& packed, size_t per_line);

/// n numbers of `size` bytes in big-endian order, from byte `offset` of the file: read, not looked at where they are mapped, so that
/// they cost their own memory only.
void read_swapped(const MappedFile& file, size_t offset, size_t n, size_t size, std::byte* out);

}  // namespace sg::vtk
