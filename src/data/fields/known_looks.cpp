// SPDX-License-Identifier: Apache-2.0
#include "data/fields/known_looks.h"

#include "data/trusted.h"

namespace sg {

namespace {

using Shows = FieldLook::Shows;

struct Known {
  std::string_view name;
  FieldLook look;
};
constexpr Known known[] = {
    {"ftle", {.shows = Shows::high, .one_sided = true, .tailed = true}},
    {"Q", {.shows = Shows::high, .two_sided = true, .tailed = true}},
    {"delta", {.shows = Shows::high, .two_sided = true, .tailed = true}},
    {"lambda2", {.shows = Shows::low, .two_sided = true, .tailed = true}},
    {"Okubo-Weiss", {.shows = Shows::low, .two_sided = true, .tailed = true}},
    {"swirling strength", {.shows = Shows::high, .tailed = true}},
    {"vorticity", {.shows = Shows::high, .tailed = true}},
    {"vorticity magnitude", {.shows = Shows::high, .tailed = true}},
    {"strain rate", {.shows = Shows::high, .tailed = true}},
    {"helicity", {.two_sided = true, .tailed = true}},
    {"divergence", {.two_sided = true, .tailed = true}},
    {"speed", {.tailed = true}},
    {"mean curvature", {.two_sided = true, .tailed = true}},
    {"Gaussian curvature", {.two_sided = true, .tailed = true}},
    {"largest curvature", {.two_sided = true, .tailed = true}},
    {"smallest curvature", {.two_sided = true, .tailed = true}},
    {"lic", {.shows = Shows::fibres, .texture = true}},
    {"spot noise", {.texture = true}},
    {"band", {.bands = true}},
    {"signed distance", {.shows = Shows::zero}},
    {"signed_distance", {.shows = Shows::zero}},
    {"SignedDistance", {.shows = Shows::zero}},
    {"sdf", {.shows = Shows::zero}},
    {"SDF", {.shows = Shows::zero}},
    {"level set", {.shows = Shows::zero}},
    {"level_set", {.shows = Shows::zero}},
    {"levelset", {.shows = Shows::zero}},
    {"LevelSet", {.shows = Shows::zero}},
};

bool has_limits_of_bands(const FieldSet& fields, const Field& band) {
  const Field *low = fields.find("band low", Association::cell), *high = fields.find("band high", Association::cell);
  return band.association == Association::cell && low && high && band.components() == 1 && !is_float(band.array.type()) &&
         low->components() == 1 && high->components() == 1;
}

}  // namespace

FieldLook known_look(std::string_view name) {
  for (const Known& k : known)
    if (k.name == name) return k.look;
  return {};
}

DatasetPtr with_known_looks(const DatasetPtr& data) {
  DatasetParts parts;
  bool any = false;
  for (const Field& f : data->fields()) {
    if (f.look != FieldLook{}) continue;  // stated
    FieldLook look = known_look(f.name);
    look.bands = look.bands && has_limits_of_bands(data->fields(), f);
    if (look == FieldLook{}) continue;
    if (!any) parts = data->parts();
    any = true;
    Field now = f;
    now.look = look;
    parts.fields.add(std::move(now));
  }
  return any ? make_trusted_dataset(std::move(parts), data->bricks()) : data;
}

DatasetPtr with_result(const DatasetPtr& data, Field field) {
  DatasetParts parts = data->parts();
  field.look.result = true;
  parts.fields.add(std::move(field));
  return make_dataset(std::move(parts));
}

void mark_result(FieldSet& fields, std::string_view name, Association association) {
  const Field* f = fields.find(name, association);
  if (!f) return;
  Field now = *f;
  now.look.result = true;
  fields.add(std::move(now));
}

}  // namespace sg
