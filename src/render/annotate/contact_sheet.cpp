// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/annotate/overlay/overlay.h"

namespace sg {

namespace {

// Average of the source pixels under each target pixel (box filter over whole pixels), alpha over white.
Image scaled(const Image& image, int width, int height) {
  Image out(width, height, 3);
  const int n = image.channels, colors = n < 3 ? 1 : 3;
  parallel_for(size_t(height), 8, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < width; ++x) {
        const int x0 = int(int64_t(x) * image.width / width), x1 = std::max(x0 + 1, int(int64_t(x + 1) * image.width / width));
        const int y0 = int(int64_t(y) * image.height / height), y1 = std::max(y0 + 1, int(int64_t(y + 1) * image.height / height));
        float sum[3] = {0, 0, 0};
        for (int v = y0; v < y1; ++v)
          for (int u = x0; u < x1; ++u) {
            const uint8_t* p = image.at(u, v);
            const float alpha = n % 2 == 0 ? float(p[n - 1]) / 255 : 1;
            for (int c = 0; c < 3; ++c) sum[c] += srgb_decode(float(p[colors == 1 ? 0 : c]) / 255) * alpha + (1 - alpha);
          }
        const float area = float((x1 - x0) * (y1 - y0));
        for (int c = 0; c < 3; ++c) out.at(x, y)[c] = uint8_t(srgb_encode(sum[c] / area) * 255 + 0.5f);
      }
  });
  return out;
}

}  // namespace

Image contact_sheet(const std::vector<CaptionedImage>& pictures, int columns, int width) {
  columns = std::max(1, std::min<int>(columns, int(std::max<size_t>(pictures.size(), 1))));
  double tallest = 0;
  for (const CaptionedImage& p : pictures)
    if (p.image.width > 0) tallest = std::max(tallest, double(p.image.height) / p.image.width);
  const int gap = 12, caption = 26, height = std::max(1, int(std::lround(width * std::min(tallest, 1.0))));
  const int rows = int((pictures.size() + size_t(columns) - 1) / size_t(columns));
  Image sheet(gap + columns * (width + gap), std::max(1, gap + rows * (height + caption + gap)), 3);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), uint8_t(236));
  Overlay overlay(sheet.width, sheet.height, false);
  TextStyle style;
  style.size = 13, style.wrap = width, style.ellipsize = true;
  for (size_t i = 0; i < pictures.size(); ++i) {
    const Image& image = pictures[i].image;
    const int left = gap + int(i % size_t(columns)) * (width + gap), top = gap + int(i / size_t(columns)) * (height + caption + gap);
    if (image.width > 0 && image.height > 0) {
      const double fit = std::min(double(width) / image.width, double(height) / image.height);
      const Image small =
          scaled(image, std::max(1, int(std::lround(image.width * fit))), std::max(1, int(std::lround(image.height * fit))));
      const int x0 = left + (width - small.width) / 2, y0 = top + (height - small.height) / 2;
      for (int y = 0; y < small.height; ++y) std::copy_n(small.at(0, y), size_t(small.width) * 3, sheet.at(x0, y0 + y));
    }
    overlay.text(pictures[i].caption, left, top + height + 4, style);
  }
  overlay.put_on(sheet);
  return sheet;
}

}  // namespace sg
