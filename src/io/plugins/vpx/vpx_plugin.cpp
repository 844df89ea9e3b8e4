// SPDX-License-Identifier: Apache-2.0
// VP9 through libvpx: constant quality, the same packets for any number of threads.
#include <fmt/core.h>
#include <vpx/vp8cx.h>
#include <vpx/vpx_encoder.h>

#include "base/error.h"
#include "base/parallel.h"
#include "io/film/movie.h"
#include "io/plugin.h"

namespace sg {

namespace {

struct Rgb {
  double r, g, b;
};

// The pixel at (x, y), the last one repeated beyond the border, over white.
Rgb pixel(const Image& image, int x, int y) {
  const uint8_t* p = image.at(std::min(x, image.width - 1), std::min(y, image.height - 1));
  const bool grey = image.channels < 3, alpha = image.channels % 2 == 0;
  const double a = alpha ? p[image.channels - 1] / 255.0 : 1, white = 255 * (1 - a);
  return {p[0] * a + white, p[grey ? 0 : 1] * a + white, p[grey ? 0 : 2] * a + white};
}

uint8_t rounded(double v) { return uint8_t(std::clamp(v + 0.5, 0.0, 255.0)); }

// ITU-R BT.709: luma 16 to 235, colour differences 16 to 240 about 128.
double luma(Rgb c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }
double blue(Rgb c) { return (c.b - luma(c)) / 1.8556; }
double red(Rgb c) { return (c.r - luma(c)) / 1.5748; }

void fill_planes(const Image& image, vpx_image_t& out) {
  const int w = int(out.d_w), h = int(out.d_h);
  parallel_for(size_t(h / 2), 16, [&](size_t begin, size_t end) {
    for (int y = 2 * int(begin); y < 2 * int(end); y += 2)
      for (int x = 0; x < w; x += 2) {
        double b = 0, r = 0;
        for (int k = 0; k < 4; ++k) {
          const Rgb c = pixel(image, x + k % 2, y + k / 2);
          out.planes[0][(y + k / 2) * out.stride[0] + x + k % 2] = rounded(16 + luma(c) * 219 / 255);
          b += blue(c), r += red(c);
        }
        out.planes[1][y / 2 * out.stride[1] + x / 2] = rounded(128 + b / 4 * 224 / 255);
        out.planes[2][y / 2 * out.stride[2] + x / 2] = rounded(128 + r / 4 * 224 / 255);
      }
  });
}

class Encoder {
 public:
  explicit Encoder(const MovieSettings& s) {
    vpx_codec_enc_cfg_t config;
    check(vpx_codec_enc_config_default(vpx_codec_vp9_cx(), &config, 0), "has no default settings");
    config.g_w = unsigned(s.width), config.g_h = unsigned(s.height);
    config.g_timebase = {1000, int(std::lround(s.fps * 1000))};
    config.g_threads = unsigned(std::clamp(thread_count(), 1, 8));
    config.g_lag_in_frames = 16;
    config.rc_end_usage = VPX_Q;
    config.kf_max_dist = unsigned(std::clamp(s.fps * 5, 1.0, 1000.0));  // a place to jump to every five seconds
    check(vpx_codec_enc_init(&codec_, vpx_codec_vp9_cx(), &config, 0), "cannot be started");
    open_ = true;
    set(VP8E_SET_CPUUSED, 4);
    set(VP8E_SET_CQ_LEVEL, unsigned(std::clamp(s.quality, 0, 63)));
    set(VP8E_SET_ENABLEAUTOALTREF, 1u);
    set(VP9E_SET_TILE_COLUMNS, 2);  // threads share columns: their number belongs to the film, not to the machine
    set(VP9E_SET_ROW_MT, 0u);
    set(VP9E_SET_COLOR_SPACE, int(VPX_CS_BT_709));
    set(VP9E_SET_COLOR_RANGE, int(VPX_CR_STUDIO_RANGE));
    if (!vpx_img_alloc(&planes_, VPX_IMG_FMT_I420, unsigned(s.width), unsigned(s.height), 32))
      fail_data(fmt::format("no memory for {} x {} pixels", s.width, s.height), "VP9");
  }
  ~Encoder() {
    vpx_img_free(&planes_);
    if (open_) vpx_codec_destroy(&codec_);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  std::vector<VideoFrame> encode(const Image* picture) {
    std::vector<VideoFrame> out;
    if (picture) {
      fill_planes(*picture, planes_);
      put(&planes_, out);
    } else {
      while (put(nullptr, out)) {
      }
    }
    return out;
  }

 private:
  template <class T>
  void set(int what, T value) {
    check(vpx_codec_control_(&codec_, what, value), "rejects a setting");
  }
  void check(vpx_codec_err_t status, const char* what) {
    if (status == VPX_CODEC_OK) return;
    const char* detail = open_ ? vpx_codec_error_detail(&codec_) : nullptr;
    fail_data(fmt::format("the VP9 encoder {}: {}{}", what, vpx_codec_err_to_string(status), detail ? std::string("; ") + detail : ""),
              "film");
  }
  // True when packets came out.
  bool put(vpx_image_t* image, std::vector<VideoFrame>& out) {
    check(vpx_codec_encode(&codec_, image, image ? count_++ : -1, 1, 0, VPX_DL_GOOD_QUALITY), "fails");
    bool any = false;
    vpx_codec_iter_t at = nullptr;
    while (const vpx_codec_cx_pkt_t* packet = vpx_codec_get_cx_data(&codec_, &at)) {
      any = true;
      if (packet->kind != VPX_CODEC_CX_FRAME_PKT) continue;
      out.push_back({std::string(static_cast<const char*>(packet->data.frame.buf), packet->data.frame.sz),
                     (packet->data.frame.flags & VPX_FRAME_IS_KEY) != 0});
    }
    return any;
  }

  vpx_codec_ctx_t codec_{};
  vpx_image_t planes_{};
  bool open_ = false;
  vpx_codec_pts_t count_ = 0;
};

MovieEncoder movie_encoder(const MovieSettings& settings) {
  const auto encoder = std::make_shared<Encoder>(settings);
  return [encoder](const Image* picture) { return encoder->encode(picture); };
}

}  // namespace

}  // namespace sg

SG_PLUGIN_FORMATS({"webm", nullptr, nullptr, nullptr, nullptr, sg::movie_encoder})
