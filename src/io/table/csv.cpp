// SPDX-License-Identifier: Apache-2.0
// Delimited text (RFC 4180, and what people write): commas, tabs, semicolons, bars, colons or blanks; quotes; UTF-8 or UTF-16.
#include <fmt/core.h>

#include <algorithm>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/table/mesh_table.h"
#include "io/table/table_columns.h"
#include "io/table/table_parts.h"
#include "io/write_losses.h"

namespace sg {

namespace {

void append_utf8(std::string& out, uint32_t c) {
  if (c < 0x80) out += char(c);
  else if (c < 0x800) out += char(0xc0 | c >> 6), out += char(0x80 | (c & 63));
  else if (c < 0x10000) out += char(0xe0 | c >> 12), out += char(0x80 | (c >> 6 & 63)), out += char(0x80 | (c & 63));
  else out += char(0xf0 | c >> 18), out += char(0x80 | (c >> 12 & 63)), out += char(0x80 | (c >> 6 & 63)), out += char(0x80 | (c & 63));
}

std::string utf8_from_utf16(std::string_view s, bool big) {
  std::string out;
  auto unit = [&](size_t i) {
    const uint32_t a = uint8_t(s[i]), b = uint8_t(s[i + 1]);
    return big ? a << 8 | b : b << 8 | a;
  };
  for (size_t i = 0; i + 1 < s.size(); i += 2) {
    uint32_t c = unit(i);
    if (c >= 0xd800 && c < 0xdc00 && i + 3 < s.size() && unit(i + 2) >= 0xdc00 && unit(i + 2) < 0xe000) {
      c = 0x10000 + ((c - 0xd800) << 10) + (unit(i + 2) - 0xdc00);
      i += 2;
    }
    append_utf8(out, c);
  }
  return out;
}

// By the byte order mark, else by where the zero bytes of ASCII characters lie.
std::string text_of(std::string_view s) {
  if (s.starts_with("\xef\xbb\xbf")) return std::string(s.substr(3));
  if (s.starts_with("\xff\xfe")) return utf8_from_utf16(s.substr(2), false);
  if (s.starts_with("\xfe\xff")) return utf8_from_utf16(s.substr(2), true);
  if (s.size() >= 8 && s.size() % 2 == 0) {
    size_t even = 0, odd = 0;
    const size_t n = std::min<size_t>(s.size(), 256) & ~size_t(1);
    for (size_t i = 0; i < n; ++i) (i % 2 ? odd : even) += s[i] == 0;
    if (even * 2 > n * 3 / 4 && odd == 0) return utf8_from_utf16(s, true);
    if (odd * 2 > n * 3 / 4 && even == 0) return utf8_from_utf16(s, false);
  }
  return std::string(s);
}

// One record: cells between delimiters; quoted ones may hold anything, "" is a quote in them. `scratch` owns unquoted copies.
const char* next_record(const char* p, const char* end, char delimiter, std::vector<std::string>& cells,
                        std::vector<bool>* in_quotes = nullptr) {
  cells.clear();
  if (in_quotes) in_quotes->clear();
  std::string cell;
  bool quoted = false, was_quoted = false;
  for (; p < end; ++p) {
    if (quoted) {
      if (*p != '"') cell += *p;
      else if (p + 1 < end && p[1] == '"') cell += *p++;
      else quoted = false;
    } else if (*p == '"' && trim(cell).empty() && !was_quoted) {
      cell.clear();
      quoted = was_quoted = true;
    } else if (*p == '\n' || *p == '\r') {
      if (*p == '\r' && p + 1 < end && p[1] == '\n') ++p;
      ++p;
      break;
    } else if (*p == delimiter || (delimiter == ' ' && *p == '\t')) {
      if (delimiter == ' ' && cell.empty() && !was_quoted) continue;  // blanks come in runs
      cells.push_back(std::move(cell));
      if (in_quotes) in_quotes->push_back(was_quoted);
      cell.clear(), was_quoted = false;
    } else {
      cell += *p;
    }
  }
  if (quoted) fail_data("has a quote that is not closed", "", "double quotes inside quotes");
  if (!(delimiter == ' ' && cell.empty() && !was_quoted)) {
    cells.push_back(std::move(cell));
    if (in_quotes) in_quotes->push_back(was_quoted);
  }
  return p;
}

bool is_blank_record(const std::vector<std::string>& cells) {
  for (const std::string& c : cells)
    if (!trim(c).empty()) return false;
  return true;
}

// The delimiter for which the first records agree best in their number of cells.
char find_delimiter(const std::string& text) {
  char best = ',';
  double best_score = 0;
  for (const char d : {',', '\t', ';', '|', ':', ' '}) {
    std::vector<size_t> sizes;
    std::vector<std::string> cells;
    const char *p = text.data(), *end = p + std::min<size_t>(text.size(), 1 << 16);
    try {
      while (p < end && sizes.size() < 50) {
        p = next_record(p, end, d, cells);
        if (!is_blank_record(cells)) sizes.push_back(cells.size());
      }
    } catch (const Error&) {  // cut within a quote
    }
    if (sizes.size() > 1 && p >= end && end < text.data() + text.size()) sizes.pop_back();  // the last record is cut
    if (sizes.empty() || sizes[0] < 2) continue;
    const double same = double(std::count(sizes.begin(), sizes.end(), sizes[0])) / double(sizes.size());
    const double score = same * (d == ' ' ? 0.5 : d == ':' ? 0.9 : 1.0);  // words hold blanks, times hold colons
    if (score > best_score + 1e-9) best = d, best_score = score;
  }
  return best_score >= 0.35 ? best : ',';
}

bool is_number(std::string_view s) { return parse_double(trim(s)).has_value(); }

struct Record {
  std::vector<std::string> cells;
  std::vector<bool> in_quotes;
};

// Whether a first record names the columns: it has no numbers; or all of it is quoted and no number of the second line is, as write_csv
// writes it; or a word is above a number. Else its numbers are data.
bool is_header(const Record& first, const Record* second) {
  bool any = false, numbers = false, quotes = true;
  for (size_t i = 0; i < first.cells.size(); ++i) {
    const bool blank = trim(first.cells[i]).empty();
    any = any || !blank;
    numbers = numbers || is_number(first.cells[i]);
    quotes = quotes && (blank || first.in_quotes[i]);
  }
  if (!any || !numbers) return any;
  bool quoted_numbers = false, above = false;
  for (size_t i = 0; second && i < second->cells.size(); ++i) {
    const bool number = is_number(second->cells[i]);
    quoted_numbers = quoted_numbers || (number && second->in_quotes[i]);
    above = above || (number && !is_missing(trim(second->cells[i])) && i < first.cells.size() && !is_number(first.cells[i]) &&
                      !is_missing(trim(first.cells[i])));
  }
  return above || (quotes && !quoted_numbers);
}

// What a reader may take for a delimiter: those that it tries before ours, and all of them where ours is never written.
std::string_view delimiters_to_quote(char delimiter, bool single) { return single ? ",\t;|: " : delimiter == '\t' ? ",\t" : ","; }

std::string quoted(std::string_view s, std::string_view delimiters, bool always = false) {
  if (!always && s.find_first_of("\"\r\n") == s.npos && s.find_first_of(delimiters) == s.npos &&
      (s.empty() || (s.front() != ' ' && s.back() != ' ')))
    return std::string(s);
  std::string r = "\"";
  for (const char c : s) r += c == '"' ? std::string("\"\"") : std::string(1, c);
  return r + '"';
}

std::string cell_text(const Table& t, size_t column, size_t row, int component) {
  const Array& a = t.columns[column].array;
  const double v = a.get(row, component);
  if (const auto* labels = t.words(column)) return v >= 0 && size_t(v) < labels->size() ? (*labels)[size_t(v)] : "";
  if (std::isnan(v)) return "";
  if (a.type() == ElementType::i64) return std::to_string(a.view<int64_t>()(row, component));
  if (a.type() == ElementType::u64) return std::to_string(a.view<uint64_t>()(row, component));
  // The fewest digits that make this f32: read as f64 and written again, they are the same text.
  return exact_number(a.type() == ElementType::f32 && std::isfinite(v) ? parse_double(fmt::format("{}", float(v))).value_or(v) : v);
}

// A table as it is, those of parts under each other; of a mesh, its points with their fields.
TablePtr table_of(const Data& data) {
  if (auto* t = std::get_if<TablePtr>(&data)) return *t;
  if (all_tables(data)) return joined_tables(*std::get<CollectionPtr>(data));
  return table_of_points(*single_dataset(data, "writing a table"));
}

}  // namespace

Data read_csv(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  const std::string text = text_of(file.text());
  if (text.find('\0') != text.npos) fail_data("holds bytes that are not text", path, "use UTF-8 or UTF-16");
  const char delimiter = find_delimiter(text);
  TableBuilder builder;
  const char *p = text.data(), *end = p + text.size();
  auto next = [&](Record& r) {
    while (p < end) {
      const char* begin = p;
      p = with_context(fmt::format("at byte {}", begin - text.data()),
                       [&] { return next_record(p, end, delimiter, r.cells, &r.in_quotes); });
      if (!is_blank_record(r.cells)) return true;
    }
    return false;
  };
  auto add = [&](const Record& r) { builder.add_row({r.cells.begin(), r.cells.end()}); };
  Record first, record;
  if (!next(first)) fail_data("has only empty lines", path, "a table needs at least one row");
  bool more = next(record);
  if (options.csv_header == HeaderLine::yes ||
      (options.csv_header == HeaderLine::automatic && is_header(first, more ? &record : nullptr))) {
    std::vector<std::string_view> names;
    for (size_t i = 0; i < first.cells.size(); ++i)
      names.push_back(first.in_quotes[i] ? std::string_view(first.cells[i]) : trim(first.cells[i]));
    builder.name_columns(names);
  } else {
    add(first);
  }
  for (; more; more = next(record)) {
    add(record);
    if (builder.rows() % 65536 == 0) context.check();
  }
  return builder.build();
}

namespace {

// The header; all in quotes where a name would be read as a number.
std::string header_line(const Table& table, char delimiter, bool single) {
  std::vector<std::string> names;
  bool number = false;
  for (const Field& f : table.columns)
    for (int c = 0; c < f.components(); ++c) {
      names.push_back(column_name(f, c));
      number = number || is_number(names.back());
    }
  std::string line;
  for (const std::string& name : names)
    line += (line.empty() ? "" : std::string(1, delimiter)) + quoted(name, delimiters_to_quote(delimiter, single), number);
  return line;
}

// Whether a column of numbers holds nothing but NaN: written so, or it would be read as one of words.
bool all_nan(const Table& t, size_t column) {
  const Array& a = t.columns[column].array;
  if (!is_float(a.type()) || t.words(column) || a.empty()) return false;
  for (size_t i = 0; i < a.count(); ++i)
    for (int c = 0; c < a.components(); ++c)
      if (!std::isnan(a.get(i, c))) return false;
  return true;
}

}  // namespace

void write_csv(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  if (!all_tables(data)) {
    const DatasetPtr d = single_dataset(data, "writing a table");
    WriteLosses losses(path, "a table");
    losses.leaves_out(*d, Association::cell), losses.leaves_out(*d, Association::whole);
    for (const Field& f : d->fields())
      if (f.association == Association::point) losses.drops_unit(f);
    losses.tell(context);
  }
  const TablePtr table = table_of(data);
  const char delimiter = extension_of(path) == "tsv" ? '\t' : ',';
  size_t rows = 0, cells = 0;
  std::vector<bool> nan_columns;
  for (size_t i = 0; i < table->columns.size(); ++i) {
    rows = std::max(rows, table->columns[i].array.count());
    cells += size_t(table->columns[i].components());
    nan_columns.push_back(all_nan(*table, i));
  }
  const std::string_view special = delimiters_to_quote(delimiter, cells == 1);
  AtomicFile file(path);
  file.write(header_line(*table, delimiter, cells == 1) + "\n");
  std::string line;
  for (size_t r = 0; r < rows; ++r) {
    line.clear();
    bool begun = false;
    for (size_t i = 0; i < table->columns.size(); ++i)
      for (int c = 0; c < table->columns[i].components(); ++c) {
        if (begun) line += delimiter;
        begun = true;
        if (r >= table->columns[i].array.count()) continue;
        const std::string text = cell_text(*table, i, r, c);
        // A line of nothing but empty cells would be none.
        line += text.empty() && (nan_columns[i] || cells == 1) && !table->words(i) ? "NaN" : quoted(text, special);
      }
    if (line.size() + 1 == std::max<size_t>(cells, 1) && is_float(table->columns[0].array.type()) && !table->words(0)) line = "NaN" + line;
    file.write(line + "\n");
  }
  file.commit();
}

}  // namespace sg
