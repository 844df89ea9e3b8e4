// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/overlay/overlay.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "render/annotate/overlay/pango.h"

namespace sg {
namespace {

template <class T, auto free_it>
struct Free {
  void operator()(T* p) const { (pango().*free_it)(p); }
};
template <class T>
using Unref = Free<T, &Pango::g_object_unref>;
using Surface = std::unique_ptr<cairo_surface_t, Free<cairo_surface_t, &Pango::cairo_surface_destroy>>;
using Cairo = std::unique_ptr<cairo_t, Free<cairo_t, &Pango::cairo_destroy>>;
using Layout = std::unique_ptr<PangoLayout, Unref<PangoLayout>>;

void use(cairo_t* cr, Vec3f c, double alpha = 1) { pango().cairo_set_source_rgba(cr, double(c.x), double(c.y), double(c.z), alpha); }

void require_a_font(PangoContext* context) {
  PangoFontDescription* wanted = pango().pango_font_description_from_string("DejaVu Sans 10");
  PangoFont* font = pango().pango_context_load_font(context, wanted);
  pango().pango_font_description_free(wanted);
  if (!font) fail_internal("no font is installed, so pictures cannot have text; install the package fonts-dejavu-core", "annotate");
  pango().g_object_unref(font);
}

}  // namespace

std::string typeset_number(const std::string& text) {
  static const char* raised[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074", "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  const size_t e = text.find('e');
  const std::string digits = text.substr(0, e);
  std::string out;
  for (char c : digits) out += c == '-' ? std::string("\u2212") : std::string(1, c);
  if (e == std::string::npos) return out;
  const auto exponent = parse_double(text.substr(e + (text[e + 1] == '+' ? 2 : 1)));
  if (!exponent) return out + text.substr(e);
  if (digits == "1") out = "10";
  else if (digits == "-1") out = "\u221210";
  else out += "\u00b710";
  for (char c : fmt::format("{:.0f}", *exponent)) out += c == '-' ? "\u207b" : raised[c - '0'];
  return out;
}

namespace {

// U+200B and U+2060: here a line may, and may not, break. Three bytes each.
constexpr std::string_view breaks[] = {"\u200b", "\u2060"};

// Names of fields may hold anything; what tells of the breaks of lines draws nothing.
std::string shown_text(std::string_view text) {
  const auto next = [&] { return std::min(text.find(breaks[0]), text.find(breaks[1])); };
  std::string shown;
  for (size_t at = next(); at != text.npos; at = next()) {
    shown.append(printable(text.substr(0, at), true)).append(text.substr(at, breaks[0].size()));
    text.remove_prefix(at + breaks[0].size());
  }
  return shown += printable(text, true);
}

}  // namespace

struct Overlay::Parts {
  Surface surface;
  Cairo cr;
  std::unique_ptr<PangoContext, Unref<PangoContext>> context;

  Layout layout(const std::string& text, const TextStyle& style) const {
    Layout layout(pango().pango_layout_new(context.get()));
    PangoFontDescription* font = pango().pango_font_description_from_string(style.bold ? "DejaVu Sans Bold" : "DejaVu Sans");
    pango().pango_font_description_set_absolute_size(font, style.size * PANGO_SCALE);
    pango().pango_layout_set_font_description(layout.get(), font);
    pango().pango_font_description_free(font);
    const std::string shown = shown_text(text);
    // Breaking a text into lines takes the square of its length: what no picture has room for is left out.
    constexpr long most_characters = 2000;
    const bool cut = pango().g_utf8_strlen(shown.data(), gssize(shown.size())) > most_characters;
    const auto bytes = cut ? pango().g_utf8_offset_to_pointer(shown.data(), most_characters) - shown.data() : ptrdiff_t(shown.size());
    pango().pango_layout_set_text(layout.get(), shown.data(), int(bytes));
    PangoAttrList* attributes = pango().pango_attr_list_new();
    pango().pango_attr_list_insert(attributes, pango().pango_attr_insert_hyphens_new(FALSE));  // a broken field name must not gain a letter
    pango().pango_layout_set_attributes(layout.get(), attributes);
    pango().pango_attr_list_unref(attributes);
    if (style.wrap > 0) {
      pango().pango_layout_set_width(layout.get(), int(style.wrap * PANGO_SCALE));
      if (style.ellipsize)
        pango().pango_layout_set_ellipsize(layout.get(), PANGO_ELLIPSIZE_END), pango().pango_layout_set_height(layout.get(), -1);
      else pango().pango_layout_set_wrap(layout.get(), style.break_words ? PANGO_WRAP_WORD_CHAR : PANGO_WRAP_WORD);
    }
    if (style.centred) pango().pango_layout_set_alignment(layout.get(), PANGO_ALIGN_CENTER);
    return layout;
  }
};

Overlay::Overlay(int width, int height, bool dark_background)
    : width_(width), height_(height), dark_(dark_background), parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.surface.reset(pango().cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height));
  if (pango().cairo_surface_status(p.surface.get()) != CAIRO_STATUS_SUCCESS)
    fail_usage(fmt::format("a picture of {} x {} pixels cannot be annotated", width, height), "annotate",
               "at most 32767 along each side are supported");
  p.cr.reset(pango().cairo_create(p.surface.get()));
  PangoFontMap* fonts = pango().pango_cairo_font_map_get_default();  // kept by Pango, one per thread: loading fonts is slow
  p.context.reset(pango().pango_font_map_create_context(fonts));
  require_a_font(p.context.get());
  pango().pango_cairo_context_set_resolution(p.context.get(), 96);
  // Nothing that depends on the machine: no hinting, no subpixel order, no rounding to pixels.
  cairo_font_options_t* options = pango().cairo_font_options_create();
  pango().cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  pango().cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  pango().cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  pango().pango_cairo_context_set_font_options(p.context.get(), options);
  pango().cairo_font_options_destroy(options);
  pango().pango_context_set_round_glyph_positions(p.context.get(), FALSE);
  pango().pango_context_set_language(p.context.get(), pango().pango_language_from_string("en"));
  pango().pango_context_set_base_dir(p.context.get(), PANGO_DIRECTION_LTR);
}

Overlay::~Overlay() = default;

TextExtent Overlay::measure(const std::string& text, const TextStyle& style) const {
  const Layout layout = parts_->layout(text, style);
  PangoRectangle logical;
  pango().pango_layout_get_extents(layout.get(), nullptr, &logical);
  return {double(logical.width) / PANGO_SCALE, double(logical.height) / PANGO_SCALE, pango().pango_layout_get_line_count(layout.get())};
}

void Overlay::show(const std::string& text, const TextStyle& style, bool halo, Vec3f color) {
  cairo_t* cr = parts_->cr.get();
  const Layout layout = parts_->layout(text, style);
  PangoRectangle logical;
  pango().pango_layout_get_extents(layout.get(), nullptr, &logical);
  // With a wrap width, Pango aligns within that width; move the lines' own box to the corner.
  pango().cairo_rel_move_to(cr, -double(logical.x) / PANGO_SCALE, 0);
  // As outlines: cached glyph pictures would be set to whole pixels, and small text would look uneven.
  pango().pango_cairo_layout_path(cr, layout.get());
  if (halo) {
    use(cr, rim(), 0.75);
    pango().cairo_set_line_width(cr, std::max(2.0, style.rim * style.size));
    pango().cairo_set_line_join(cr, CAIRO_LINE_JOIN_BEVEL);
    pango().cairo_set_tolerance(cr, 0.3);
    pango().cairo_stroke_preserve(cr);
    pango().cairo_set_tolerance(cr, 0.1);
  }
  use(cr, color);
  pango().cairo_fill(cr);
  pango().cairo_new_path(cr);
}

void Overlay::text(const std::string& text, double x, double y, const TextStyle& style, bool halo) {
  pango().cairo_move_to(parts_->cr.get(), x, y);
  show(text, style, halo, ink());
}

void Overlay::colored_text(const std::string& text, double x, double y, const TextStyle& style, Vec3f color) {
  pango().cairo_move_to(parts_->cr.get(), x, y);
  show(text, style, true, color);
}

void Overlay::set_origin(int x, int y) {
  pango().cairo_identity_matrix(parts_->cr.get());
  pango().cairo_translate(parts_->cr.get(), x, y);
  x_ = x, y_ = y;
}

void Overlay::keep_clear(const std::vector<Rect>& rects) {
  cairo_t* cr = parts_->cr.get();
  pango().cairo_reset_clip(cr);
  for (const Rect& r : rects) {
    pango().cairo_set_fill_rule(cr, CAIRO_FILL_RULE_EVEN_ODD);
    pango().cairo_rectangle(cr, -x_, -y_, width_, height_);
    pango().cairo_rectangle(cr, r.x, r.y, r.width, r.height);
    pango().cairo_clip(cr);
  }
  pango().cairo_set_fill_rule(cr, CAIRO_FILL_RULE_WINDING);
}

void Overlay::text_upwards(const std::string& text, double x, double y, const TextStyle& style) {
  cairo_t* cr = parts_->cr.get();
  pango().cairo_save(cr);
  pango().cairo_translate(cr, x, y + measure(text, style).width);
  pango().cairo_rotate(cr, -1.57079632679489662);
  pango().cairo_move_to(cr, 0, 0);
  show(text, style, true, ink());
  pango().cairo_restore(cr);
}

void Overlay::text_turned(const std::string& text, Vec2 center, double angle, const TextStyle& style, const Vec3f* color) {
  cairo_t* cr = parts_->cr.get();
  const TextExtent e = measure(text, style);
  pango().cairo_save(cr);
  pango().cairo_translate(cr, center.x, center.y);
  pango().cairo_rotate(cr, -angle);
  pango().cairo_move_to(cr, -0.5 * e.width, -0.5 * e.height);
  show(text, style, true, color ? *color : ink());
  pango().cairo_restore(cr);
}

void Overlay::line(Vec2 from, Vec2 to, double width, double alpha) {
  cairo_t* cr = parts_->cr.get();
  use(cr, ink(), alpha);
  pango().cairo_set_line_width(cr, width);
  pango().cairo_move_to(cr, from.x, from.y);
  pango().cairo_line_to(cr, to.x, to.y);
  pango().cairo_stroke(cr);
}

void Overlay::colored_line(const std::vector<Vec2>& points, double width, Vec3f color) {
  cairo_t* cr = parts_->cr.get();
  pango().cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  for (const auto& [w, c, alpha] : {std::tuple{width + 2, rim(), 0.6}, std::tuple{width, color, 1.0}}) {
    use(cr, c, alpha);
    pango().cairo_set_line_width(cr, w);
    pango().cairo_move_to(cr, points.front().x, points.front().y);
    for (size_t i = 1; i < points.size(); ++i) pango().cairo_line_to(cr, points[i].x, points[i].y);
    pango().cairo_stroke(cr);
  }
  pango().cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
}

void Overlay::frame(const Rect& r, double alpha) {
  cairo_t* cr = parts_->cr.get();
  use(cr, ink(), alpha);
  pango().cairo_set_line_width(cr, 1);
  pango().cairo_rectangle(cr, r.x, r.y, r.width, r.height);
  pango().cairo_stroke(cr);
}

void Overlay::polygon(const std::vector<Vec2>& points, Vec3f color, bool outlined) {
  cairo_t* cr = parts_->cr.get();
  for (const Vec2& p : points) pango().cairo_line_to(cr, p.x, p.y);
  pango().cairo_close_path(cr);
  use(cr, color);
  outlined ? pango().cairo_fill_preserve(cr) : pango().cairo_fill(cr);
  if (!outlined) return;
  use(cr, ink(), 0.6);
  pango().cairo_set_line_width(cr, 1);
  pango().cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  pango().cairo_stroke(cr);
}

void Overlay::put_on(Image& image) const {
  cairo_surface_t* surface = parts_->surface.get();
  pango().cairo_surface_flush(surface);
  const uint8_t* data = pango().cairo_image_surface_get_data(surface);
  const size_t stride = size_t(pango().cairo_image_surface_get_stride(surface));
  const bool alpha = image.channels % 2 == 0;
  const int colors = image.channels - alpha;
  parallel_for(size_t(height_), 32, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < width_; ++x) {
        uint32_t argb;
        std::memcpy(&argb, data + size_t(y) * stride + 4 * size_t(x), 4);
        const uint32_t a = argb >> 24;
        if (a == 0) continue;
        uint8_t* p = image.at(x, y);
        // Both as premultiplied 0..255*255; the image's own alpha counts for what lies below.
        const uint32_t below = (255 - a) * (alpha ? p[colors] : 255u), total = 255 * a + below;
        for (int c = 0; c < colors; ++c) {
          const uint32_t over = colors == 1 ? argb & 255 : argb >> (16 - 8 * c) & 255;
          p[c] = uint8_t(std::min<uint32_t>(255, (255 * 255 * over + below * p[c] + total / 2) / total));
        }
        if (alpha) p[colors] = uint8_t((total + 127) / 255);
      }
  });
}

}  // namespace sg
