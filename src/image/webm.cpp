// SPDX-License-Identifier: Apache-2.0
#include "image/webm.h"

#include <fmt/core.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/error.h"

namespace sg {

namespace {

// Element ids, as stored in the file (RFC 9559, section 5).
enum Id : uint32_t {
  ebml = 0x1A45DFA3,
  ebml_version = 0x4286,
  ebml_read_version = 0x42F7,
  ebml_max_id = 0x42F2,
  ebml_max_size = 0x42F3,
  doc_type = 0x4282,
  doc_version = 0x4287,
  doc_read_version = 0x4285,
  segment = 0x18538067,
  seek_head = 0x114D9B74,
  seek = 0x4DBB,
  seek_id = 0x53AB,
  seek_position = 0x53AC,
  info = 0x1549A966,
  timestamp_scale = 0x2AD7B1,
  duration = 0x4489,
  muxing_app = 0x4D80,
  writing_app = 0x5741,
  tracks = 0x1654AE6B,
  track_entry = 0xAE,
  track_number = 0xD7,
  track_uid = 0x73C5,
  track_type = 0x83,
  flag_lacing = 0x9C,
  default_duration = 0x23E383,
  codec_id = 0x86,
  video = 0xE0,
  pixel_width = 0xB0,
  pixel_height = 0xBA,
  colour = 0x55B0,
  matrix_coefficients = 0x55B1,
  colour_range = 0x55B9,
  transfer = 0x55BA,
  primaries = 0x55BB,
  cluster = 0x1F43B675,
  timestamp = 0xE7,
  simple_block = 0xA3,
  cues = 0x1C53BB6B,
  cue_point = 0xBB,
  cue_time = 0xB3,
  cue_positions = 0xB7,
  cue_track = 0xF7,
  cue_cluster = 0xF1,
};

std::string big_endian(uint64_t v, int bytes) {
  std::string s;
  for (int i = bytes; i-- > 0;) s += char(v >> (8 * i));
  return s;
}

std::string id_bytes(uint32_t id) { return big_endian(id, id > 0xFFFFFF ? 4 : id > 0xFFFF ? 3 : id > 0xFF ? 2 : 1); }

// A size of 8 bytes everywhere: 7 bytes more an element, and every place is known beforehand.
std::string element(Id id, std::string_view content) {
  return id_bytes(id) + big_endian((uint64_t(1) << 56) | content.size(), 8) + std::string(content);
}
std::string number(Id id, uint64_t v) { return element(id, big_endian(v, 8)); }
std::string real(Id id, double v) { return element(id, big_endian(std::bit_cast<uint64_t>(v), 8)); }

constexpr int64_t longest_cluster = 5000;  // ms; a block's own time has 16 bits

std::string track_text(const WebmTrack& t) {
  const std::string colours =
      element(colour, number(matrix_coefficients, 1) + number(colour_range, 1) + number(transfer, 1) + number(primaries, 1));
  const std::string picture = element(video, number(pixel_width, uint64_t(t.width)) + number(pixel_height, uint64_t(t.height)) + colours);
  return element(tracks, element(track_entry, number(track_number, 1) + number(track_uid, 1) + number(track_type, 1) +
                                                  number(flag_lacing, 0) + number(default_duration, uint64_t(std::llround(1e9 / t.fps))) +
                                                  element(codec_id, t.codec) + picture));
}

}  // namespace

std::string webm_file(const WebmTrack& track, std::span<const VideoFrame> frames) {
  if (frames.empty()) fail_usage("a film needs at least one picture", "webm");
  if (!frames[0].key) fail_internal("the first picture of a film must be a key frame", "webm");
  if (track.width < 1 || track.height < 1 || track.width > 16384 || track.height > 16384)
    fail_usage(fmt::format("{} x {} pixels is not a valid film size", track.width, track.height), "webm", "1 to 16384");
  if (!(track.fps >= 0.01 && track.fps <= 1000)) fail_usage(fmt::format("{} pictures per second", track.fps), "webm", "0.01 to 1000");
  const auto ms = [&](size_t n) { return std::llround(double(n) * 1000 / track.fps); };

  const std::string begin =
      element(ebml, number(ebml_version, 1) + number(ebml_read_version, 1) + number(ebml_max_id, 4) + number(ebml_max_size, 8) +
                        element(doc_type, "webm") + number(doc_version, 4) + number(doc_read_version, 2));
  const std::string about = element(info, number(timestamp_scale, 1'000'000) + real(duration, double(frames.size()) * 1000 / track.fps) +
                                              element(muxing_app, track.writer) + element(writing_app, track.writer));
  const std::string picture = track_text(track);
  const auto places = [&](uint64_t cues_at) {
    const auto entry = [](Id id, uint64_t at) { return element(seek, element(seek_id, id_bytes(id)) + number(seek_position, at)); };
    const auto all = [&](uint64_t a, uint64_t b) { return element(seek_head, entry(info, a) + entry(tracks, b) + entry(cues, cues_at)); };
    const uint64_t size = all(0, 0).size();
    return all(size, size + about.size());
  };

  // Places count from the first byte in the segment.
  const uint64_t head = places(0).size() + about.size() + picture.size();
  std::string clusters, points;
  for (size_t n = 0; n < frames.size();) {
    const int64_t start = ms(n);
    std::string content = number(timestamp, uint64_t(start));
    if (frames[n].key)
      points += element(cue_point, number(cue_time, uint64_t(start)) +
                                       element(cue_positions, number(cue_track, 1) + number(cue_cluster, head + clusters.size())));
    const size_t first = n;
    for (; n < frames.size() && (n == first || (!frames[n].key && ms(n) - start < longest_cluster)); ++n)
      content += element(simple_block, "\x81" + big_endian(uint64_t(ms(n) - start), 2) + (frames[n].key ? '\x80' : '\0') + frames[n].bytes);
    clusters += element(cluster, content);
  }
  return begin + element(segment, places(head + clusters.size()) + about + picture + clusters + element(cues, points));
}

}  // namespace sg
