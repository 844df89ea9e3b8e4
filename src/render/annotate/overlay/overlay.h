// SPDX-License-Identifier: Apache-2.0
// Overlay: what text and rulers are drawn on, a transparent layer that is put over the picture at the end.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/vec.h"
#include "image/image.h"

typedef struct _cairo cairo_t;

namespace sg {

struct Rect {
  double x = 0, y = 0, width = 0, height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
  bool overlaps(const Rect& o) const { return x < o.right() && o.x < right() && y < o.bottom() && o.y < bottom(); }
  Rect grown(double by) const { return {x - by, y - by, width + 2 * by, height + 2 * by}; }
};

/// How a text is set. Lengths are pixels.
struct TextStyle {
  double size = 15;         ///< of the font
  double wrap = 0;          ///< break lines beyond this width; 0 = one line
  bool break_words = true;  ///< with wrap: words longer than a line are broken
  bool ellipsize = false;   ///< with wrap: one line, cut with "..." instead of broken
  bool centred = false;     ///< lines among each other
  bool bold = false;
  double rim = 0.2;  ///< width of a halo's stroke, in sizes
};

struct TextExtent {
  double width = 0, height = 0;
  int lines = 0;
};

/// The text of a number for readers: a real minus sign, and "2e-6" with the power of ten raised.
std::string typeset_number(const std::string& text);

/// Loads a library that has what sets text (Pango; the first overlay does). Throws Error(internal) that names the package to install.
void load_text_library(const std::string& name);

class Overlay {
 public:
  /// Throws Error(internal) naming the package when no font is installed.
  Overlay(int width, int height, bool dark_background);
  ~Overlay();
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  /// All that follows is drawn, and width() and height() count, from this pixel of the picture on.
  void set_origin(int x, int y);

  int width() const { return width_ - x_; }
  int height() const { return height_ - y_; }
  bool dark() const { return dark_; }

  // Texts are any bytes: what would act on a terminal or is not UTF-8 is spelled out (printable()), and after U+200B a line may break, at
  // U+2060 not.
  TextExtent measure(const std::string& text, const TextStyle& style) const;
  /// Top left corner at (x, y). `halo` puts a rim of the background's colour round the letters.
  void text(const std::string& text, double x, double y, const TextStyle& style, bool halo = false);
  /// Turned by 90 degrees, read upwards; (x, y) is the top left corner of the turned box (width and height swapped).
  void text_upwards(const std::string& text, double x, double y, const TextStyle& style);

  /// Turned by an angle (radians, anticlockwise) about its middle at `center`, with a halo.
  void text_turned(const std::string& text, Vec2 center, double angle, const TextStyle& style, const Vec3f* color = nullptr);

  /// Nothing is drawn within these rectangles until the next call; an empty list lifts that.
  void keep_clear(const std::vector<Rect>& rects);

  void line(Vec2 from, Vec2 to, double width, double alpha = 1);
  void frame(const Rect& rect, double alpha);
  void polygon(const std::vector<Vec2>& points, Vec3f color, bool outlined);
  void colored_line(Vec2 from, Vec2 to, double width, Vec3f color) { colored_line({from, to}, width, color); }
  /// Through two points at least.
  void colored_line(const std::vector<Vec2>& points, double width, Vec3f color);
  void colored_text(const std::string& text, double x, double y, const TextStyle& style, Vec3f color);

  /// Over the image (1 to 4 channels of the same size).
  void put_on(Image& image) const;

 private:
  struct Parts;
  void show(const std::string& text, const TextStyle& style, bool halo, Vec3f color);
  Vec3f ink() const { return dark_ ? Vec3f{0.93f, 0.93f, 0.95f} : Vec3f{0.09f, 0.09f, 0.11f}; }
  Vec3f rim() const { return dark_ ? Vec3f{0.05f, 0.05f, 0.07f} : Vec3f{1, 1, 1}; }
  int width_, height_, x_ = 0, y_ = 0;
  bool dark_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sg
