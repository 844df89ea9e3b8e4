// SPDX-License-Identifier: Apache-2.0
// String arrays of VTK XML files: codes of characters, each string ended by 0. Words of points and cells become categories.
#include <fmt/core.h>

#include "base/text/text.h"
#include "io/text/word_categories.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/xml/vtk_xml_pieces.h"

namespace sg::vtk {

namespace {

bool is_string(pugi::xml_node n) { return std::string_view(n.attribute("type").value()) == "String"; }

// Not more than `most`, and one, so that there are seen to be too many.
std::vector<std::string> strings_of(const XmlFile& file, pugi::xml_node element, size_t most) {
  const Array codes = file.codes(element);
  std::vector<std::string> all;
  std::string one;
  const auto v = codes.view<int8_t>();
  for (size_t i = 0; i < v.count && all.size() <= most; ++i) {
    if (v[i] != 0) {
      one += char(v[i]);
      continue;
    }
    all.push_back(std::move(one));
    one.clear();
  }
  if (!one.empty()) all.push_back(std::move(one));
  return all;
}

pugi::xml_node string_array(const XmlPiece& piece, const char* element, std::string_view name) {
  for (const pugi::xml_node& data : piece.node.children(element))
    for (const pugi::xml_node& n : data.children())
      if (is_string(n) && name == n.attribute("Name").value()) return n;
  return {};
}

}  // namespace

void add_categories(const XmlRead& read, const std::vector<XmlPiece>& pieces, const char* element, Association association,
                    const std::vector<size_t>& tuples, DatasetParts& parts) {
  if (pieces.empty()) return;
  for (const pugi::xml_node& data : pieces[0].node.children(element))
    for (const pugi::xml_node& first : data.children()) {
      const std::string name = first.attribute("Name").value();
      if (!is_string(first) || name.empty() || !is_wanted(read, name) || parts.fields.find(name, association)) continue;
      size_t total = 0;
      for (const size_t n : tuples) total += n;
      std::vector<std::string> all;
      for (size_t i = 0; i < pieces.size() && !read.options.header_only; ++i) {
        const pugi::xml_node n = string_array(pieces[i], element, name);
        std::vector<std::string> some = n ? strings_of(*pieces[i].file, n, tuples[i]) : std::vector<std::string>(tuples[i]);
        if (some.size() != tuples[i])
          pieces[i].file->fail(fmt::format("has {} strings for {} {}s", some.size() > tuples[i] ? "more" : std::to_string(some.size()),
                                           tuples[i], association_name(association)),
                               n);
        all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
      }
      if (read.options.header_only) {
        parts.fields.add({name, association, hollow(ElementType::i32, total, 1), "", Role::labels});
        continue;
      }
      auto categories = word_categories(name, all);
      if (!categories) {
        read.context.info(
            fmt::format("the strings '{}' are left out: more than {} different ones are no categories", name, most_categories));
        continue;
      }
      parts.fields.add({name, association, Array::from_vector(std::move(categories->numbers)), "", Role::labels});
      parts.notes.push_back(std::move(categories->note));
    }
}

void add_texts(const XmlRead& read, pugi::xml_node parent, DatasetParts& parts) {
  constexpr size_t most_lines = 100;
  for (const pugi::xml_node& data : parent.children("FieldData"))
    for (const pugi::xml_node& n : data.children()) {
      const std::string name = n.attribute("Name").value();
      if (!is_string(n) || name.empty()) continue;
      const std::vector<std::string> lines = strings_of(read.file, n, most_lines);
      if (lines.empty() || lines.size() > most_lines) continue;
      std::string text;
      for (const std::string& line : lines) text += (&line == &lines[0] ? "" : "\n") + line;
      parts.notes.emplace_back(name, text);
    }
}

}  // namespace sg::vtk
