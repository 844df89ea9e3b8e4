// SPDX-License-Identifier: Apache-2.0
// What is shown when nothing is said.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "data/lattice.h"
#include "io/lent_series.h"
#include "pipeline/picture/picture_parts.h"
#include "scene/choose/own_materials.h"
#include "scene/choose/scale.h"
#include "scene/choose/shown_range.h"
#include "scene/choose/telling_field.h"
#include "scene/choose/view/crowded_box.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

// The steps that nobody takes as input: what is to be seen when nothing is said.
std::vector<std::string> open_ends(const PipelineFile& file) {
  std::vector<std::string> used, ends;
  for (size_t i = 0; i < file.steps.size(); ++i) {
    const auto& s = file.steps[i];
    if (!s.from.empty()) used.insert(used.end(), s.from.begin(), s.from.end());
    else if (i > 0 && !s.reads()) {
      const Operation* op = known_operation(s.operation);
      if (!op || op->kind == OperationKind::filter) used.push_back(file.steps[i - 1].name);
    }
  }
  for (const auto& s : file.steps)
    if (std::find(used.begin(), used.end(), s.name) == used.end()) ends.push_back(s.name);
  return ends;
}

std::string free_name(const PipelineFile& file, const std::string& wanted) {
  for (int n = 0;; ++n) {
    const std::string name = n ? fmt::format("{}_{}", wanted, n + 1) : wanted;
    if (std::none_of(file.steps.begin(), file.steps.end(), [&](const auto& s) { return s.name == name; })) return name;
  }
}

}  // namespace

std::string box_words(const Box3& b) {
  constexpr double parts = 1000;
  std::vector<std::string> ends;
  for (int a = 0; a < 3; ++a) {
    const double size = b.hi[a] - b.lo[a], step = size > 0 ? std::pow(10, std::floor(std::log10(size / parts))) : 0;
    for (const double end : {b.lo[a], b.hi[a]})
      ends.push_back(step > 0 ? short_number(std::round(end / step) * step, 12) : exact_number(end));
  }
  return fmt::format("{}", fmt::join(ends, ","));
}

std::string added_step(PipelineFile& file, const std::string& operation, std::vector<std::string> words, const std::string& from) {
  const std::string name = free_name(file, operation);
  file.steps.push_back({name, operation, std::move(words), {from}, 0});
  return name;
}

void fail_no_mesh(const Data& data, const std::string& where) {
  const Table* table = nullptr;
  std::string parts;
  if (auto* t = std::get_if<TablePtr>(&data)) table = t->get();
  if (auto* c = std::get_if<CollectionPtr>(&data))
    for (const Collection::Part& part : (*c)->parts)
      if (std::holds_alternative<TablePtr>(part.data)) parts += (parts.empty() ? "" : ", ") + part.name;
  if (!parts.empty()) fail_usage(fmt::format("holds tables ({}) and no mesh to show", parts), where, "table_to_points needs one table");
  if (!table) fail_usage("there is no mesh to show", where);
  std::vector<std::string> numbers;
  for (size_t i = 0; i < table->columns.size(); ++i)
    if (!table->words(i)) numbers.push_back(table->columns[i].name);
  if (numbers.size() < 2) fail_usage("is a table with fewer than two columns of numbers; there is no mesh to show", where);
  fail_usage("is a table; there is no mesh to show", where,
             fmt::format("read it with `sightglass info`, keep it with `sightglass convert -o NAME.csv`, or make points of its rows: "
                         "-f \"table_to_points x='{}' y='{}'\"",
                         numbers[0], numbers[1]));
}

namespace {

// A number that tells parts apart in which nothing else varies; "" for none.
std::string field_telling_parts(const Data& data, const Context& context) {
  std::vector<DatasetPtr> parts;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { parts.push_back(d); });
  if (parts.size() < 2 || std::any_of(parts.begin(), parts.end(), [](const DatasetPtr& d) { return has_own_materials(*d); })) return "";
  for (const Field& of_first : parts[0]->fields()) {
    std::vector<FieldOf> fields;
    for (const DatasetPtr& d : parts)
      if (const Field* f = d->fields().find(of_first.name); f && f->association != Association::whole) fields.push_back({d.get(), f});
    if (fields.size() == parts.size() && !labels_of(fields, false, context).values.empty()) return of_first.name;
  }
  return "";
}

// The field that colours the parts, in each of them that has it.
std::vector<FieldOf> coloring_fields(const Data& data, const std::string& name) {
  std::vector<FieldOf> fields;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    const Field* f = name.empty() ? automatic_field(*d) : d->fields().find(name);
    if (f && (fields.empty() || f->name == fields[0].field->name) && f->association != Association::whole) fields.push_back({d.get(), f});
  });
  return fields;
}

// Surfaces, lines and points: of a volume the scale is its opacity, too.
bool takes_decades(const Data& data, const std::string& name, const Look& look, const Context& context) {
  if (look.shows.size() != 1 || look.shows[0].kind->is<VolumeShow>() || !look.shows[0].kind->coloring) return false;
  if (!look.shows[0].kind->coloring(look.shows[0].params)->color.empty()) return false;
  const std::vector<FieldOf> fields = coloring_fields(data, name);
  return !fields.empty() && spans_decades(fields, context);
}

// Of a flat domain in which something happens in a small part alone, such as a wing's far field: this part.
void cut_to_crowd(const Data& data, const std::string& name, Look& look) {
  if (!look.camera.parallel || !look.filter.empty() || look.shows.size() != 1 || !look.shows[0].kind->is<SurfaceShow>()) return;
  const std::vector<FieldOf> fields = coloring_fields(data, name);
  const auto box = crowded_box(fields);
  if (!box) return;
  Box3 b = *box;
  const double reach = b.diagonal();  // nothing is cut off across the plane
  for (int a = 0; a < 3; ++a)
    if (std::abs(look.camera.direction[a]) > 0.5 * length(look.camera.direction)) b.lo[a] -= reach, b.hi[a] += reach;
  look.filter = {"clip", "box=" + box_words(b)};
  look.shows[0].of_input = false;
  look.reason += fmt::format("; '{}' hardly varies but in a small part, which is shown; --show surface shows all", fields[0].field->name);
}

// A displacement of the points, by its name; null where the points are displaced by nothing.
const Field* displacement_of(const Dataset& d) {
  if (is_lattice(d.mesh())) return nullptr;
  for (const Field& f : d.fields())
    if (f.association == Association::point && f.components() == 3 && to_lower(f.name).starts_with("disp") && d.range(f).hi > 0) return &f;
  return nullptr;
}

bool states_scale(const PipelineFile::Show& s) { return word_value(s.words, "scale") || word_value(s.words, "range"); }

// The step, where it reads a file of which nothing but the name is said.
PipelineFile::Step* plain_reading(PipelineFile& file, const std::string& step) {
  for (PipelineFile::Step& s : file.steps)
    if (s.name == step)
      return s.reads() && s.words.size() == 1 && word_value(s.words, "path") && !is_lent(*word_value(s.words, "path")) ? &s : nullptr;
  return nullptr;
}

// The filters of a look as steps after `end`, and its shows, coloured as is stated.
void add_shows(const Look& look, PipelineFile& file, std::vector<PipelineFile::Show>& shows, const std::string& end,
               const std::vector<std::string>& coloring) {
  std::string result = end;
  for (const auto& words : {look.prepare, look.filter})
    if (!words.empty()) result = added_step(file, words[0], {words.begin() + 1, words.end()}, result);
  for (const Look::Show& s : look.shows) {
    const ShowKind& kind = *s.kind;
    std::vector<std::string> words = changed_words(s.params);
    if (kind.coloring && kind.coloring(s.params)->color.empty()) words.insert(words.end(), coloring.begin(), coloring.end());
    std::string of = s.of_input ? end : result;
    if (!s.filter.empty()) of = added_step(file, s.filter[0], {s.filter.begin() + 1, s.filter.end()}, end);
    shows.push_back({std::string(kind.name), words, of, 0});
  }
}

// What suits the result of a step, as entries under `show`; the filters that it needs are added to the steps.
// `alone`: no other input may share its colours.
Look choose_for(const PipelineFile::Show& wanted, Data data, bool alone, PipelineFile& file, std::vector<PipelineFile::Show>& shows,
                std::vector<std::string>& notes, Context& context) {
  std::string end = wanted.of;
  const std::string origin = origin_of(file, end), extension = extension_of_origin(file, end),
                    stated = word_value(wanted.words, "field").value_or("");
  leave_out_sets(file, end, data, stated.empty() ? std::vector<std::string>() : std::vector{stated}, notes, context);
  if (const auto* table = std::get_if<TablePtr>(&data))
    if (const auto curve = look_at_table(**table, stated)) {
      add_shows(*curve, file, shows, end, {});
      return *curve;
    }
  // The largest part speaks for all; one with values before one with a mask or a numbering alone.
  DatasetPtr largest;
  std::vector<DatasetPtr> parts;
  bool has_values = false;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    parts.push_back(d);
    const Field* f = automatic_field(*d);
    const bool values = d->point_count() > 0 && f && f->role != Role::labels;
    if (!largest || (values && !has_values) || (values == has_values && d->point_count() > largest->point_count()))
      largest = d, has_values = values;
  });
  if (!largest) fail_no_mesh(data, file_name_of(origin));
  if (!stated.empty()) largest->fields().require(stated);
  const Field* made = automatic_field(*largest);
  const std::string field = !stated.empty() ? stated : !made ? field_telling_parts(data, context) : made->look.result ? made->name : "";
  std::vector<std::string> coloring = wanted.words;
  if (field != stated) coloring.push_back("field=" + field);
  PipelineFile::Step* reading = parts.size() > 1 ? nullptr : plain_reading(file, end);
  Look look = choose_look(*largest, field, extension, reading != nullptr);
  if (!look.source.empty()) reading->operation = look.source;
  // What is seen of a volume was told for the scale that it chooses by itself.
  if (states_scale(wanted) || !alone)
    if (const size_t at = look.reason.find("shown as a volume;"); at != look.reason.npos) look.reason.resize(look.reason.find(';', at));
  if (const Field* u = displacement_of(*largest)) look.reason += fmt::format("; -f warp shows its shape displaced by '{}'", u->name);
  if (is_shape_of_file(file, end))
    if (const std::string up = stand_upright(parts, extension, look.camera); !up.empty()) look.reason += "; " + up;
  if (const CameraParams camera = stated_in(file).camera; !camera.position && !camera.direction && !camera.view)
    face_detail(look, parts, extension, context);
  cut_open(look, largest, field, context);
  if (parts.size() == 1) show_flow(look, largest, field, context);
  cut_to_crowd(data, field, look);
  show_rigid(look, parts, field, context);
  if (takes_decades(data, field, look, context) && !states_scale(wanted) && !word_value(wanted.words, "map")) {
    coloring.push_back("scale=log");
    look.reason += ", on a logarithmic scale, as most values are far below the largest (scale=linear is the other)";
  }
  add_shows(look, file, shows, end, coloring);
  return look;
}

// What one open end shows: its place in the list of shows, and the box of its data.
struct Chosen {
  std::string name;
  Box3 box;
  size_t begin, end;
};

bool surrounds(const Box3& outer, const Box3& inner) {
  const double hair = 1e-6 * outer.diagonal();
  for (int a = 0; a < 3; ++a)
    if (inner.lo[a] < outer.lo[a] - hair || inner.hi[a] > outer.hi[a] + hair) return false;
  return true;
}

// "a.vtp", "a.vtp and b.vtp", "a.vtp, b.vtp and 9 others".
std::string names_text(const std::vector<std::string>& names) {
  if (names.size() == 1) return names[0];
  if (names.size() == 2) return fmt::format("{} and {}", names[0], names[1]);
  return fmt::format("{}, {} and {} other{}", names[0], names[1], names.size() - 2, names.size() == 3 ? "" : "s");
}

// Inputs of which the same is said, in the order of the first of each.
class ByNote {
 public:
  void add(const std::string& note, const std::string& name) {
    const auto at = std::find_if(all_.begin(), all_.end(), [&](const auto& a) { return a.first == note; });
    (at == all_.end() ? all_.emplace_back(note, std::vector<std::string>()) : *at).second.push_back(name);
  }
  const auto& all() const { return all_; }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> all_;
};

// No input hides another: the surface of one that surrounds an earlier or a smaller one is drawn see-through.
void see_through(const std::vector<Chosen>& inputs, std::vector<PipelineFile::Show>& shows, std::vector<std::string>& notes) {
  constexpr const char* faint = "opacity=0.35";
  ByNote by_inner;
  for (size_t outer = 0; outer < inputs.size(); ++outer)
    for (size_t inner = 0; inner < inputs.size(); ++inner) {
      const Chosen &o = inputs[outer], &i = inputs[inner];
      if (outer == inner || i.box.empty() || !surrounds(o.box, i.box) || (surrounds(i.box, o.box) && outer < inner)) continue;
      bool changed = false;
      for (size_t s = o.begin; s < o.end; ++s)
        if (find_show(shows[s].kind).is<SurfaceShow>() && !word_value(shows[s].words, "opacity"))
          shows[s].words.push_back(faint), changed = true;
      if (changed) by_inner.add(i.name, o.name);
    }
  for (const auto& [inner, outer] : by_inner.all())
    notes.push_back(fmt::format("{} {} {}: drawn with {}, so that {} are seen", names_text(outer),
                                outer.size() == 1 ? "surrounds" : "surround", inner, faint, outer.size() == 1 ? "both" : "all"));
}

// Several views of one thing: where nothing is said of the view, and each gets enough pixels.
bool room_for_views(const PipelineFile& file, const StatedPicture& stated) {
  constexpr int width = 480, height = 360;
  const auto& words = file.picture;
  const bool own_view = std::any_of(words.begin(), words.end(), [](const std::string& w) { return w.starts_with("camera"); });
  return !own_view && stated.picture.layout.empty() && stated.width >= width && stated.height >= height;
}

}  // namespace

Look choose_looks(PipelineFile& file, const PictureOptions& options, const GraphOptions& graph, std::vector<Data>& held,
                  std::vector<std::string>& notes, Context& context) {
  if (file.show.empty())
    for (const std::string& end : open_ends(file)) file.show.push_back({std::string(auto_show), {}, end, 0});
  for (auto& s : file.show)
    if (s.kind == auto_show || find_show(s.kind).coloring) s.words.insert(s.words.end(), options.coloring.begin(), options.coloring.end());
  const auto open = std::count_if(file.show.begin(), file.show.end(), [](const auto& s) { return s.kind == auto_show; });
  if (open == 0) return {};
  const PipelineGraph built = build_graph(file, graph, options.results);
  Look first;
  std::vector<PipelineFile::Show> shows;
  std::vector<Chosen> inputs;
  ByNote reasons;
  for (size_t i = 0; i < file.show.size(); ++i) {
    PipelineFile::Show wanted = file.show[i];
    if (wanted.of.empty()) wanted.of = built.nodes.back().first;  // steps may follow
    if (wanted.kind != auto_show) {
      shows.push_back(std::move(wanted));
      continue;
    }
    const int node = wanted.node;
    const Data data = held.emplace_back(built.graph.evaluate(built.show[i], {}, context));
    Chosen& input = inputs.emplace_back(Chosen{file_name_of(origin_of(file, wanted.of)), {}, shows.size(), 0});
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { input.box.add(d->bounds()); });
    const Look look = choose_for(wanted, data, open == 1, file, shows, notes, context);
    input.end = shows.size();
    for (size_t k = input.begin; k < input.end; ++k) shows[k].node = node;
    reasons.add(look.reason, input.name);
    if (first.shows.empty()) first = look;
  }
  for (const auto& [reason, names] : reasons.all()) notes.push_back(open > 1 ? fmt::format("{}: {}", names_text(names), reason) : reason);
  const StatedPicture stated = stated_in(file);
  if (!in_panels(stated.picture) && file.scene.empty()) see_through(inputs, shows, notes);
  if (shows.size() == 1 && file.scene.empty()) {
    for (const std::string& word : first.picture) {
      const std::string_view key = std::string_view(word).substr(0, word.find('='));
      if (word_value(file.picture, key) || (key == "views" && !room_for_views(file, stated))) continue;
      file.picture.push_back(word);
    }
    const bool own_camera = stated.camera.position || stated.camera.target;
    if (first.frame && stated.picture.frame.empty() && !own_camera && !states_scale(shows[0])) {
      file.picture.push_back("frame=" + box_words(*first.frame));
      notes.push_back(fmt::format("the rest of the volume is transparent: the picture is of {}", file.picture.back()));
    }
  }
  file.show = std::move(shows);
  return first;
}

}  // namespace sg
