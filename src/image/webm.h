// SPDX-License-Identifier: Apache-2.0
// WebM files: one track of VP9 pictures. Sources: RFC 8794 (EBML), RFC 9559 (Matroska), the WebM container guidelines.
#pragma once
#include <span>
#include <string>

namespace sg {

/// One encoded picture.
struct VideoFrame {
  std::string bytes;
  bool key = false;  ///< can be shown without the preceding ones
};

struct WebmTrack {
  int width = 0, height = 0;
  double fps = 25;
  std::string codec = "V_VP9";
  std::string writer = "Sightglass";
};

/// The whole file: header, index of places, track (BT.709, limited range), clusters that begin at key frames and hold at most 5 s, cues.
/// The first frame is a key frame. The same bytes for the same frames. Throws Error(usage) without frames or for sizes and rates that make
/// no film.
std::string webm_file(const WebmTrack& track, std::span<const VideoFrame> frames);

}  // namespace sg
