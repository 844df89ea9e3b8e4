// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/transfer_questions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "filter/probe/probe.h"
#include "scene/choose/volume/derivatives.h"
#include "scene/show/volume_presets.h"
#include "serve/renderer/questions/place_values.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

// The volume that a question names by its show; null where there is none.
const VolumeItem* volume_of(const Json& question, const PreparedPicture& prepared) {
  const auto show = uint32_t(question["show"].whole()) + 1;
  const Scene& scene = prepared.shown[0].scene;
  for (size_t i = 0; i < scene.shows.size(); ++i)
    if (const auto* volume = std::get_if<VolumeItem>(&scene.items[i]); volume && scene.shows[i] == show) return volume;
  return nullptr;
}

constexpr size_t most_samples = 400'000;

double second_of(const DerivativeSample& s, SecondAxis axis) {
  switch (axis) {
    case SecondAxis::second_derivative: return s.second_derivative;
    case SecondAxis::curvature: return s.curvature;
    default: return s.gradient;
  }
}

struct PlaneSample {
  double value, second;
};

// What two fields have in the same places, spread over all of them.
std::vector<PlaneSample> samples_of_fields(const Field& field, int component, const Field& second) {
  const size_t n = field.array.count();
  size_t step = std::max<size_t>(1, (n + most_samples - 1) / most_samples);
  while (step > 1 && std::gcd(step, n) > 1) ++step;  // else samples line up along the rows of a lattice
  std::vector<PlaneSample> samples;
  for (size_t i = 0; i < n; i += step)
    samples.push_back({component < 0 ? size_at(field.array, i) : field.array.get(i, component), size_at(second.array, i)});
  return samples;
}

std::vector<PlaneSample> samples_of(const VolumeItem& volume, const Field& field, SecondAxis axis, const Field* second, Context& context) {
  if (second) return samples_of_fields(field, volume.component, *second);
  std::vector<PlaneSample> samples;
  for (const DerivativeSample& s :
       sample_derivatives(volume.data, field, volume.component, axis != SecondAxis::gradient, most_samples, context))
    samples.push_back({double(s.value), second_of(s, axis)});
  return samples;
}

// Value and second axis at a place; the gradient by differences over the width of a cell. Nothing outside, and where more than that is
// asked.
Json plane_place(const VolumeItem& volume, const Field& field, SecondAxis axis, const Field* other, Vec3 at, Context& context) {
  if (axis != SecondAxis::gradient && !other) return {};
  const Box3 b = volume.data->bounds();
  const Vec3 size = b.hi - b.lo;
  const double width = std::cbrt(size.x * size.y * size.z / double(std::max<size_t>(1, volume.data->cell_count())));
  ProbeAtParams p;
  p.points = {at.x, at.y, at.z};
  for (int a = 0; a < 3 && !other; ++a)
    for (const double side : {-0.5, 0.5}) {
      Vec3 beside = at;
      beside[a] += side * width;
      p.points.insert(p.points.end(), {beside.x, beside.y, beside.z});
    }
  const DatasetPtr there = probe_at(volume.data, p, context);
  const Field* valid = there->fields().find("valid", Association::point);
  const auto value = [&](const Field& f, int component, size_t i) {
    const Field* probed = there->fields().find(f.name, Association::point);
    if (!probed || !valid || valid->array.get(i) == 0) return std::nan("");
    return component < 0 ? size_at(probed->array, i) : probed->array.get(i, component);
  };
  const auto of_field = [&](size_t i) { return value(field, volume.component, i); };
  double squares = 0;
  for (size_t a = 0; a < 3 && !other; ++a) squares += std::pow((of_field(2 * a + 2) - of_field(2 * a + 1)) / width, 2);
  const double second = other ? value(*other, -1, 0) : std::sqrt(squares);
  return std::isfinite(of_field(0)) && std::isfinite(second) ? numbers({of_field(0), second}) : Json();
}

}  // namespace

// Looks of a volume that suit the data, each with its reason: the presets, and what the histogram and the boundaries tell.
Json::Members answer_proposals(const Json& q, const PreparedPicture& prepared, Context& context) {
  std::vector<Json> proposals;
  if (const VolumeItem* volume = volume_of(q, prepared)) {
    const auto propose = [&](std::string name, std::vector<std::string> words, std::string reason) {
      proposals.emplace_back(
          Json::Members{{"name", text(std::move(name))}, {"words", words_json(words)}, {"reason", text(std::move(reason))}});
    };
    for (const TransferChoice choice : {TransferChoice::histogram, TransferChoice::boundaries}) {
      Scene alone;
      VolumeShow p;
      p.coloring.field.name = volume->field, p.transfer = std::string(word_of(choice));
      std::string reason;
      Context told(context, 0, 1);
      told.on_log = [&](LogLevel, std::string_view line) { reason += (reason.empty() ? "" : "; ") + std::string(line); };
      add(alone, volume->data, p, told);
      propose(p.transfer, transfer_words(std::get<VolumeItem>(alone.items.at(0))), reason);
    }
    for (const VolumePreset& preset : volume_presets()) {
      Scene alone;
      VolumeShow p;
      p.coloring.field.name = volume->field, p.preset = std::string(preset.name);
      try {
        add(alone, volume->data, p, context);
      } catch (const Error& e) {
        if (e.kind() == ErrorKind::cancelled) throw;
        continue;  // not for such data
      }
      propose(p.preset, transfer_words(std::get<VolumeItem>(alone.items.at(0))), std::string(preset.about));
    }
  }
  return {{"list", Json(std::move(proposals))}};
}

Json::Members answer_plane(const Json& q, const PreparedPicture& prepared, Context& context) {
  constexpr size_t columns = 64, rows = 48;
  const VolumeItem* volume = volume_of(q, prepared);
  const Field* field = volume ? volume->data->fields().find(volume->field, volume->association) : nullptr;
  if (!field) fail_usage("there is no volume to ask about", "plane");
  SecondAxis axis = volume->detail.second;
  const Field* other = axis == SecondAxis::field ? volume->data->fields().find(volume->detail.second_field, volume->association) : nullptr;
  if (axis == SecondAxis::none || (axis == SecondAxis::field && !other)) axis = SecondAxis::gradient;
  if (q.contains("at")) return {{"at", plane_place(*volume, *field, axis, other, place_of(q["at"], "at"), context)}};
  const Range value = volume->data->range(*field, volume->component);
  const Range second = second_axis_range(volume->data, *field, volume->component, axis, other, context);
  std::vector<uint64_t> counts(columns * rows);
  const auto bin = [](double v, Range r, size_t n) {
    const double t = r.hi > r.lo ? (v - r.lo) / (r.hi - r.lo) : 0;
    return t >= 0 && t <= 1 ? std::min(size_t(t * double(n)), n - 1) : n;
  };
  for (const PlaneSample& s : samples_of(*volume, *field, axis, other, context)) {
    const size_t i = bin(s.value, value, columns), j = bin(s.second, second, rows);
    if (i < columns && j < rows) ++counts[i + columns * j];
  }
  std::vector<Json> list;
  for (const uint64_t n : counts) list.emplace_back(n);
  return {{"value", numbers({value.lo, value.hi})},
          {"second", numbers({second.lo, second.hi})},
          {"size", numbers({double(columns), double(rows)})},
          {"counts", Json(std::move(list))}};
}

}  // namespace sg::serve
