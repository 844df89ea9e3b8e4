// SPDX-License-Identifier: Apache-2.0
// Pango and Cairo, loaded when the first text is set: with the thirty libraries that they bring, a program would take twice as long to
// start.
#pragma once
#include <pango/pangocairo.h>

// What is used of them.
#define SG_PANGO_FUNCTIONS(F)                 \
  F(cairo_clip)                               \
  F(cairo_close_path)                         \
  F(cairo_create)                             \
  F(cairo_destroy)                            \
  F(cairo_fill)                               \
  F(cairo_fill_preserve)                      \
  F(cairo_font_options_create)                \
  F(cairo_font_options_destroy)               \
  F(cairo_font_options_set_antialias)         \
  F(cairo_font_options_set_hint_metrics)      \
  F(cairo_font_options_set_hint_style)        \
  F(cairo_identity_matrix)                    \
  F(cairo_image_surface_create)               \
  F(cairo_image_surface_get_data)             \
  F(cairo_image_surface_get_stride)           \
  F(cairo_line_to)                            \
  F(cairo_move_to)                            \
  F(cairo_new_path)                           \
  F(cairo_rectangle)                          \
  F(cairo_rel_move_to)                        \
  F(cairo_reset_clip)                         \
  F(cairo_restore)                            \
  F(cairo_rotate)                             \
  F(cairo_save)                               \
  F(cairo_set_fill_rule)                      \
  F(cairo_set_line_cap)                       \
  F(cairo_set_line_join)                      \
  F(cairo_set_line_width)                     \
  F(cairo_set_source_rgba)                    \
  F(cairo_set_tolerance)                      \
  F(cairo_stroke)                             \
  F(cairo_stroke_preserve)                    \
  F(cairo_surface_destroy)                    \
  F(cairo_surface_flush)                      \
  F(cairo_surface_status)                     \
  F(cairo_translate)                          \
  F(g_object_unref)                           \
  F(g_utf8_offset_to_pointer)                 \
  F(g_utf8_strlen)                            \
  F(pango_attr_insert_hyphens_new)            \
  F(pango_attr_list_insert)                   \
  F(pango_attr_list_new)                      \
  F(pango_attr_list_unref)                    \
  F(pango_cairo_context_set_font_options)     \
  F(pango_cairo_context_set_resolution)       \
  F(pango_cairo_font_map_get_default)         \
  F(pango_cairo_layout_path)                  \
  F(pango_context_load_font)                  \
  F(pango_context_set_base_dir)               \
  F(pango_context_set_language)               \
  F(pango_context_set_round_glyph_positions)  \
  F(pango_font_description_free)              \
  F(pango_font_description_from_string)       \
  F(pango_font_description_set_absolute_size) \
  F(pango_font_map_create_context)            \
  F(pango_language_from_string)               \
  F(pango_layout_get_extents)                 \
  F(pango_layout_get_line_count)              \
  F(pango_layout_new)                         \
  F(pango_layout_set_alignment)               \
  F(pango_layout_set_attributes)              \
  F(pango_layout_set_ellipsize)               \
  F(pango_layout_set_font_description)        \
  F(pango_layout_set_height)                  \
  F(pango_layout_set_text)                    \
  F(pango_layout_set_width)                   \
  F(pango_layout_set_wrap)

namespace sg {

struct Pango {
#define SG_PANGO_MEMBER(name) decltype(&::name) name = nullptr;
  SG_PANGO_FUNCTIONS(SG_PANGO_MEMBER)
#undef SG_PANGO_MEMBER
};

/// Loads them at the first call. Throws as load_text_library() does.
const Pango& pango();

}  // namespace sg
