// SPDX-License-Identifier: Apache-2.0
// The format of a file whose name does not tell it: stated by the user (ReadOptions::format), or recognized by the content alone.
#pragma once
#include "io/io.h"

namespace sg {

/// Whether `word` is one of the format's extensions or its name, in letters of either case.
bool is_called(const Format& f, std::string_view word);
/// Throws Error(usage) naming the nearest extension where no format that is read is called so; "" is right.
void check_stated_format(const std::string& word);
/// Of the formats called so, the one that accepts the content. Throws Error(data) where none does.
const Format& stated_format(const std::string& word, std::span<const std::byte> whole, const std::string& path);
/// The one whose Format::recognize() accepts the content; null for none.
const Format* recognized(std::span<const std::byte> whole);
/// The extension that tells what a file holds: of the stated format, else the file's own where a format has it, else of the format that is
/// found by its content.
std::string telling_extension(const std::string& path, const std::string& stated);
/// "its content looks like OBJ: ..." in an error; "" where nothing recognizes it.
std::string recognized_hint(std::span<const std::byte> whole);

}  // namespace sg
