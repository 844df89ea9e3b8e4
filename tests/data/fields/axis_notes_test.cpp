// SPDX-License-Identifier: Apache-2.0
#include "data/fields/axis_notes.h"

#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr with_axis(const AxisNote& note) {
  DatasetParts parts;
  parts.mesh = UniformGrid();
  note_axis(parts.notes, 2, note);
  return make_dataset(std::move(parts));
}

}  // namespace

TEST_CASE("axis notes: what is noted is read back, and tells title and direction") {
  struct Case {
    AxisNote note;
    const char *text, *title;
    bool down;
  };
  const Case cases[] = {
      {{"lon", "degrees_east", ""}, "lon, degrees_east (drawn flat)", "lon [degrees east]", false},
      {{"latitude", "degree_N", ""}, "latitude, degree_N (drawn flat)", "latitude [degrees north]", false},
      {{"depth", "m", "down"}, "depth, m, positive down", "depth [m]", true},
      {{"depth", "m", ""}, "depth, m", "depth [m]", true},
      {{"depth", "m", "up"}, "depth, m, positive up", "depth [m]", false},
      {{"level", "hPa", ""}, "level, hPa", "level [hPa]", true},
      {{"height", "m", ""}, "height, m", "height [m]", false},
      {{"step", "", ""}, "step", "step", false},
      {{"t", "days, hours", "Down"}, "t, days, hours, positive Down", "t [days, hours]", true},
  };
  for (const Case& c : cases) {
    CAPTURE(c.text);
    const DatasetPtr d = with_axis(c.note);
    REQUIRE(d->notes().size() == 1);
    CHECK(d->notes()[0].first == "z axis");
    CHECK(d->notes()[0].second == c.text);
    const auto read = axis_note(*d, 2);
    REQUIRE(read);
    CHECK(read->name == c.note.name);
    CHECK(read->unit == c.note.unit);
    CHECK(read->positive == c.note.positive);
    CHECK(read->title() == c.title);
    CHECK(read->down() == c.down);
    CHECK(read->in_degrees() == (c.note.unit.find("deg") == 0));
    CHECK(!axis_note(*d, 0));
  }
}
