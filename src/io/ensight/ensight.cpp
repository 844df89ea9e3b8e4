// SPDX-License-Identifier: Apache-2.0
// EnSight Gold and EnSight 6: a case file, a geometry and one file per variable. Source: EnSight User Manual, "EnSight Gold Casefile
// Format".
#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/ensight/ensight6.h"
#include "io/ensight/variables.h"
#include "io/formats.h"
#include "io/mesh/unread.h"

namespace sg {

using namespace ensight;

namespace {

bool is_wanted_variable(const ReadOptions& o, const Variable& v) {
  if (is_wanted(o.fields, v.name)) return true;
  return v.complex && (is_wanted(o.fields, v.name + "_r") || is_wanted(o.fields, v.name + "_i"));
}

void add_constant(const CaseFile& c, const Variable& v, std::optional<double> time, Geometry& g) {
  const TimeSet* set = v.file.time_set ? find_time_set(c, v.file.time_set) : nullptr;
  const size_t step = set ? step_at(*set, time) : 0;
  const double value = v.constants[std::min(step, v.constants.size() - 1)];
  for (Part& p : g.parts) p.data.fields.add({v.name, Association::whole, Array::from_vector(std::vector<double>{value}), "", Role::none});
}

Stream open_at(const CaseFile& c, const FileRef& ref, std::optional<double> time, std::optional<Form> form) {
  const FileStep f = file_at(c, ref, time);
  MappedFile file(f.path);
  const Form kind = form ? *form : Stream::form_of(file);
  Stream s(std::move(file), kind);
  if (f.step >= 0) s.seek_step(f.step);
  return s;
}

/// The particles of a measured geometry as one more part; their numbers are in `particles`.
void add_measured(const CaseFile& c, std::optional<double> time, Geometry& g) {
  Stream s = open_at(c, *c.measured, time, {});
  if (s.form() != Form::ascii) s.line("the form");
  s.line("a description");
  const std::string k = to_lower(s.keyword("particle coordinates"));
  if (k != "particle coordinates") s.fail(fmt::format("found '{}' where 'particle coordinates' was expected", k.substr(0, 40)));
  const size_t n = s.count("particles", 16);
  PointCloud cloud;
  if (s.form() == Form::ascii) {
    const Array v = s.reals(4 * n, "particles");
    cloud.points.xyz = Array(v.buffer(), ElementType::f32, n, 3, 4, 16, 4).made_packed();
  } else {
    s.skip_numbers(n, "particle ids");
    const Array v = s.reals(3 * n, "particles");
    cloud.points.xyz = Array(v.buffer(), ElementType::f32, n, 3);
  }
  Part p;
  p.number = -1;
  p.name = "measured particles";
  p.points = n;
  p.data.mesh = std::move(cloud);
  g.parts.push_back(std::move(p));
}

void add_measured_variable(Stream& s, const Variable& v, Part& particles) {
  s.line("a description");
  const auto k = size_t(v.components());
  const Array a = s.reals(particles.points * k, "values of particles");
  particles.data.fields.add({v.name, Association::point, Array(a.buffer(), ElementType::f32, particles.points, int(k)), "", Role::none});
}

void add_variable(const CaseFile& c, const Variable& v, std::optional<double> time, const Stream& model, bool look_only, Geometry& g) {
  if (v.kind == VariableKind::constant) return add_constant(c, v, time, g);
  Stream s = open_at(c, v.file, time, model.form());
  s.take_order(model);
  if (v.measured) {
    if (!g.parts.empty() && g.parts.back().number == -1) add_measured_variable(s, v, g.parts.back());
    return;
  }
  const auto read = c.gold ? read_variable : read_variable6;
  read(s, v, v.complex ? v.name + "_r" : v.name, g, look_only);
  if (!v.complex) return;
  Stream im = open_at(c, v.imaginary, time, model.form());
  read(im, v, v.name + "_i", g, look_only);
  if (v.kind == VariableKind::scalar) join_complex(v.name, v.association, g);
}

}  // namespace

bool sniff_ensight(std::span<const std::byte> head) {
  std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  bool format = false;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line[0] == '#') continue;
    if (!format) {
      if (line != "FORMAT") return false;
      format = true;
    } else {
      const std::string l = to_lower(line);
      return l.starts_with("type") && l.find("ensight") != std::string::npos && l.find("master_server") == std::string::npos;
    }
  }
  return false;
}

std::vector<double> times_ensight(const std::string& path, const ReadOptions&, Context&) { return parse_case(path).times(); }

Data read_ensight(const std::string& path, const ReadOptions& options, Context& context) {
  const CaseFile c = parse_case(path);
  for (const std::string& what : c.left_out) context.warn(fmt::format("{}: {} is left out", path, what));
  const std::vector<double> times = c.times();
  std::optional<double> time;
  if (!times.empty()) time = times[chosen_step(times, options, path)];
  else if (options.step > 0) fail_usage(fmt::format("there is no time step {}", options.step), path, "it has one");

  Stream s = open_at(c, c.model, time, {});
  Geometry g = c.gold ? read_geometry(s, context) : read_geometry6(s, context);
  if (c.measured) add_measured(c, time, g);
  size_t done = 0;
  for (const Variable& v : c.variables) {
    context.progress(double(++done) / double(c.variables.size() + 1), "reading variables");
    context.check();
    if (is_wanted_variable(options, v)) add_variable(c, v, time, s, options.header_only, g);
  }
  if (g.parts.empty()) fail_data("has no parts", s.path());
  auto r = std::make_shared<Collection>();
  for (Part& p : g.parts) {
    p.data.time = time;
    if (!g.description.empty()) p.data.notes.emplace_back("description", g.description);
    r->parts.push_back(
        {p.name, with_context(fmt::format("making part {} '{}'", p.number, p.name), [&] { return make_dataset(std::move(p.data)); })});
  }
  return r;
}

}  // namespace sg
