// SPDX-License-Identifier: Apache-2.0
// XDMF: the XML tree, its references and includes.
#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/text/text_scan.h"
#include "io/xdmf/xdmf.h"

namespace sg::xdmf {

namespace {

std::string_view local_name(const char* name) {
  const std::string_view n(name);
  const size_t colon = n.find(':');
  return colon == n.npos ? n : n.substr(colon + 1);
}

// Whether children(.., name) means it.
bool named(pugi::xml_node n, std::string_view name) {
  return is_named(n, name) || (name == "DataItem" && (is_named(n, "DataStructure") || is_named(n, "DataTransform")));
}

// <!ENTITY name "text"> of the document type; files of version 2 name their heavy data so.
std::map<std::string, std::string> entities_of(std::string_view text) {
  std::map<std::string, std::string> found;
  const size_t end = std::min(text.find("<Xdmf"), std::min<size_t>(text.size(), 1 << 16));
  text = text.substr(0, end);
  for (size_t at = text.find("<!ENTITY"); at != text.npos && found.size() < 64; at = text.find("<!ENTITY", at + 1)) {
    const auto w = words(text.substr(at + 8, text.find('>', at) - at - 8));
    if (w.size() == 2 && w[1].size() >= 2 && (w[1].front() == '"' || w[1].front() == '\'') && w[1].back() == w[1].front())
      found[std::string(w[0])] = std::string(w[1].substr(1, w[1].size() - 2));
  }
  return found;
}

}  // namespace

bool is_named(pugi::xml_node n, std::string_view name) { return equal_ignoring_case(local_name(n.name()), name); }

pugi::xml_attribute find_attribute(pugi::xml_node node, std::string_view name) {
  for (const pugi::xml_attribute& a : node.attributes())
    if (equal_ignoring_case(a.name(), name)) return a;
  return {};
}

std::string_view attribute(pugi::xml_node node, std::string_view name, std::string_view older) {
  const pugi::xml_attribute a = find_attribute(node, name);
  return trim((a || older.empty() ? a : find_attribute(node, older)).value());
}

Document::Document(const std::string& path, Context& context) : path_(path), context_(context), file_(path) {
  const std::string_view text = file_.text();
  const pugi::xml_parse_result r =
      document_.load_buffer(text.data(), text.size(), pugi::parse_cdata | pugi::parse_escapes | pugi::parse_wconv_attribute);
  if (!r) {
    const auto at = std::min(size_t(std::max<ptrdiff_t>(r.offset, 0)), text.size());
    fail_data(fmt::format("is not well-formed XML: {}", r.description()), fmt::format("{}: line {}", path, line_number(text, at)),
              "the file is truncated or damaged");
  }
  if (!is_named(root(), "Xdmf"))
    fail_data(fmt::format("has the root element <{}>", root().name()), path, "an XDMF file begins with <Xdmf>");
  entities_ = entities_of(text);
}

std::string Document::where(pugi::xml_node node) const {
  const auto at = size_t(std::max<ptrdiff_t>(node.offset_debug(), 0));
  std::string name = fmt::format("<{}", node.name());
  if (const auto a = find_attribute(node, "Name")) name += fmt::format(" Name=\"{}\"", a.value());
  return fmt::format("{}: line {}, {}>", path_, line_number(file_.text(), std::min(at, file_.size())), name);
}

void Document::fail(std::string problem, pugi::xml_node node, std::string hint) const {
  fail_data(std::move(problem), where(node), std::move(hint));
}

std::string Document::with_entities(std::string text) const {
  if (text.find('&') == text.npos) return text;
  for (const auto& [name, value] : entities_) {
    const std::string reference = "&" + name + ";";
    for (size_t at = text.find(reference); at != text.npos && text.size() < 1 << 20; at = text.find(reference, at + value.size()))
      text.replace(at, reference.size(), value);
  }
  return text;
}

std::vector<pugi::xml_node> Document::select(const std::string& xpath, pugi::xml_node from) const {
  std::vector<pugi::xml_node> found;
  if (xpath.size() > 4096) fail("has a path of more than 4096 characters", from);
  const bool absolute = xpath.starts_with('/');  // every step of a series may hold the same path
  if (const auto known = absolute ? selected_.find(xpath) : selected_.end(); known != selected_.end()) return known->second;
  try {
    for (const pugi::xpath_node& n : from.select_nodes(xpath.c_str()))
      if (n.node() && found.size() < 100000) found.push_back(n.node());
  } catch (const pugi::xpath_exception& e) {
    fail(fmt::format("has the path '{}', which is not an XPath: {}", xpath, e.what()), from);
  }
  if (absolute && selected_.size() < 10000) selected_[xpath] = found;
  return found;
}

pugi::xml_node Document::resolve(pugi::xml_node node) const {
  for (int depth = 0; depth < deepest; ++depth) {
    const std::string_view reference = attribute(node, "Reference");
    if (reference.empty()) return node;
    const std::string path(trim(equal_ignoring_case(reference, "XML") ? std::string_view(node.child_value()) : reference));
    const auto found = select(path, node);
    if (found.empty()) fail(fmt::format("refers to '{}', which is not there", path), node);
    node = found[0];
  }
  fail("refers to itself", node);
}

std::vector<pugi::xml_node> Document::children(pugi::xml_node parent, std::string_view name) const {
  std::vector<pugi::xml_node> out;
  for (const pugi::xml_node& n : parent.children()) {
    if (named(n, name)) out.push_back(resolve(n));
    if (!named(n, "include")) continue;
    if (out.size() > 1000000) fail("has too many elements through inclusion", parent);
    if (const std::string_view href = n.attribute("href").value(); !href.empty() && href != file_name_of(path_))
      fail(fmt::format("includes '{}': parts of other files are not supported", href), n, "put the grids into one file");
    std::string_view pointer = trim(n.attribute("xpointer").value());
    if (pointer.starts_with("xpointer(") && pointer.ends_with(")")) pointer = pointer.substr(9, pointer.size() - 10);
    else fail(fmt::format("has the xpointer '{}'", pointer), n, "xpointer(PATH)");
    for (const pugi::xml_node& target : select(std::string(pointer), n))
      if (named(target, name)) out.push_back(resolve(target));
  }
  return out;
}

pugi::xml_node Document::child(pugi::xml_node parent, std::string_view name) const {
  const auto all = children(parent, name);
  return all.empty() ? pugi::xml_node() : all[0];
}

bool Document::is_borrowed(pugi::xml_node grid) const { return std::find(lenders_.begin(), lenders_.end(), grid) != lenders_.end(); }

void Document::note_references() {
  auto visit = [&](auto&& self, pugi::xml_node parent, int depth) -> void {
    for (const pugi::xml_node& grid : parent.children()) {
      if (!is_named(grid, "Grid")) continue;
      for (const char* part : {"Topology", "Geometry"})
        if (const pugi::xml_node p = child(grid, part); p && p.parent() != grid && !is_borrowed(p.parent())) lenders_.push_back(p.parent());
      if (depth < deepest) self(self, grid, depth + 1);
    }
  };
  for (const pugi::xml_node& domain : root().children())
    if (is_named(domain, "Domain")) visit(visit, domain, 0);
}

}  // namespace sg::xdmf
