// SPDX-License-Identifier: Apache-2.0
#include "image/webm.h"

#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include "support/test.h"

using namespace sg;

namespace {

struct Element {
  uint32_t id = 0;
  size_t begin = 0, end = 0;  // of the content, in the file
};

// A variable-length number (RFC 8794, section 4); ids keep their marker.
uint64_t vint(const std::string& file, size_t& at, bool keep) {
  const auto first = uint8_t(file.at(at));
  const int length = std::countl_zero(first) + 1;
  uint64_t v = keep ? first : first & (0xFF >> length);
  for (int i = 1; i < length; ++i) v = v << 8 | uint8_t(file.at(at + size_t(i)));
  at += size_t(length);
  return v;
}

std::vector<Element> children(const std::string& file, size_t begin, size_t end) {
  std::vector<Element> out;
  while (begin < end) {
    Element e;
    e.id = uint32_t(vint(file, begin, true));
    const uint64_t size = vint(file, begin, false);
    e.begin = begin, e.end = begin + size;
    REQUIRE(e.end <= end);
    out.push_back(e);
    begin = e.end;
  }
  return out;
}

const Element& child(const std::vector<Element>& all, uint32_t id) {
  for (const Element& e : all)
    if (e.id == id) return e;
  FAIL("no such element");
  return all[0];
}

uint64_t number(const std::string& file, const Element& e) {
  uint64_t v = 0;
  for (size_t i = e.begin; i < e.end; ++i) v = v << 8 | uint8_t(file[i]);
  return v;
}

}  // namespace

TEST_CASE("webm: sizes, places, times and pictures stand where the format says") {
  std::vector<VideoFrame> frames;
  for (int i = 0; i < 200; ++i) frames.push_back({std::string(size_t(10 + i), char(i)), i == 0 || i == 70});
  WebmTrack track;
  track.width = 320, track.height = 200, track.fps = 12.5;
  const std::string file = webm_file(track, frames);
  const auto top = children(file, 0, file.size());
  REQUIRE(top.size() == 2);
  CHECK(top[0].id == 0x1A45DFA3);
  const Element type = child(children(file, top[0].begin, top[0].end), 0x4282);
  CHECK(file.substr(type.begin, type.end - type.begin) == "webm");
  const auto parts = children(file, top[1].begin, top[1].end);

  // Every place in the seek head is that of the element it names.
  size_t seeks = 0;
  for (const Element& s : children(file, parts[0].begin, parts[0].end)) {
    const auto seek = children(file, s.begin, s.end);
    size_t at = top[1].begin + number(file, child(seek, 0x53AC));
    CHECK(vint(file, at, true) == number(file, child(seek, 0x53AB)));
    ++seeks;
  }
  CHECK(seeks == 3);
  const auto info = children(file, child(parts, 0x1549A966).begin, child(parts, 0x1549A966).end);
  CHECK(std::bit_cast<double>(number(file, child(info, 0x4489))) == 16000);
  const auto tracks = children(file, child(parts, 0x1654AE6B).begin, child(parts, 0x1654AE6B).end);
  const auto entry = children(file, tracks[0].begin, tracks[0].end);
  CHECK(number(file, child(entry, 0x23E383)) == 80'000'000);
  const auto video = children(file, child(entry, 0xE0).begin, child(entry, 0xE0).end);
  CHECK(number(file, child(video, 0xB0)) == 320);
  CHECK(number(file, child(video, 0xBA)) == 200);

  size_t n = 0, clusters = 0;
  std::vector<size_t> keyed;  // places of clusters that begin with a key frame
  for (const Element& c : parts) {
    if (c.id != 0x1F43B675) continue;
    ++clusters;
    uint64_t start = 0;
    bool first = true;
    for (const Element& e : children(file, c.begin, c.end)) {
      if (e.id == 0xE7) start = number(file, e);
      if (e.id != 0xA3) continue;
      REQUIRE(n < frames.size());
      const uint64_t time = start + (uint8_t(file[e.begin + 1]) << 8 | uint8_t(file[e.begin + 2]));
      CHECK(time == n * 80);
      const bool key = uint8_t(file[e.begin + 3]) == 0x80;
      CHECK(key == frames[n].key);
      CHECK((first || !key));
      if (key) keyed.push_back(c.begin - 12 - top[1].begin);  // 4 bytes of id, 8 of size
      CHECK(file.substr(e.begin + 4, e.end - e.begin - 4) == frames[n].bytes);
      first = false, ++n;
    }
  }
  CHECK(n == 200);
  CHECK(clusters == 5);  // 5.6 s, cut at 5 s, and 10.4 s
  std::vector<size_t> cued;
  for (const Element& p : children(file, child(parts, 0x1C53BB6B).begin, child(parts, 0x1C53BB6B).end)) {
    const auto point = children(file, p.begin, p.end);
    cued.push_back(number(file, child(children(file, child(point, 0xB7).begin, child(point, 0xB7).end), 0xF1)));
  }
  CHECK(cued == keyed);
  CHECK(file == webm_file(track, frames));
}

TEST_CASE("webm: what makes no film is refused") {
  WebmTrack track;
  track.width = 2, track.height = 2;
  const std::vector<VideoFrame> one{{"x", true}}, late{{"x", false}};
  CHECK(test::error_of([&] { webm_file(track, {}); }).find("at least one picture") != std::string::npos);
  CHECK(test::error_of([&] { webm_file(track, late); }).find("key frame") != std::string::npos);
  track.fps = 0;
  CHECK(test::error_of([&] { webm_file(track, one); }).find("pictures per second") != std::string::npos);
  track.fps = 25, track.width = 0;
  CHECK(test::error_of([&] { webm_file(track, one); }).find("not a valid film size") != std::string::npos);
}
