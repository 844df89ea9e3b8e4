// SPDX-License-Identifier: Apache-2.0
// The parts of make_picture(): what is stated, what is chosen, what is drawn.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/picture/picture.h"
#include "pipeline/picture/picture_sets.h"
#include "pipeline/picture/scene/picture_scene.h"
#include "render/annotate/annotate.h"
#include "scene/camera_params.h"
#include "scene/look/look.h"

namespace sg {

/// Settings from the words under `picture`.
struct StatedPicture {
  PictureParams picture;
  CameraParams camera;
  int width = 0, height = 0;
  Vec3f bottom{1, 1, 1};
  std::optional<Vec3f> top;
  bool transparent = false;
  std::vector<PictureNote> notes;
  Lighting lighting;  ///< its picture is read by read_environment()
};

/// Throws Error(usage).
StatedPicture stated_in(const PipelineFile& file);

/// Throws Error(usage) for data without a mesh; of tables it says how to make points.
[[noreturn]] void fail_no_mesh(const Data& data, const std::string& where);

/// A step and, one after the other, the first inputs that lead to it.
std::vector<const PipelineFile::Step*> steps_behind(const PipelineFile& file, std::string name);
/// The file a step's data comes from, for messages; "" for sources.
std::string origin_of(const PipelineFile& file, const std::string& step);
/// telling_extension() of that file; "" for sources.
std::string extension_of_origin(const PipelineFile& file, const std::string& step);
/// Where the result of a step was cut open by the plane of a `clip`, turns the view to the side of the cut (mirrored in that plane).
void face_cut(const PipelineFile& file, const std::string& step, CameraDefaults& camera);
/// Tensor glyphs of a thin slab stand out of it a little; it is seen straight on as if it were flat.
void face_slab(const PipelineFile& file, const std::string& step, Box3 box, CameraDefaults& camera);
/// `line_labels` makes points of which nothing but `labels` tells: `lines` of it are those that were labelled, `surface` and `volume` what
/// these were drawn upon.
void show_what_is_labelled(PipelineFile& file, std::vector<std::string>& notes);
/// Planes cut through data are drawn unlit, so that colours are those of the legend whichever way they face, unless light or one colour is
/// stated.
void show_planes_as_measured(PipelineFile& file);
/// Is it what a file holds, or what is made of that without changing a surface into another kind of mesh, or another kind into a surface?
bool is_shape_of_file(const PipelineFile& file, const std::string& step);
/// Is a contour made?
bool has_contour(const PipelineFile& file);
/// Adds options.coloring to every way to show that colours by a field, and puts what suits the data in the place of every `auto` show (when
/// nothing is shown: of every step that no other takes as input), adding steps to the file where needed. Returns the look of the first
/// `auto`; one without shows where there is none. `held` keeps what was looked at, so that the cache finds it again and nothing is computed
/// twice.
Look choose_looks(PipelineFile& file, const PictureOptions& options, const GraphOptions& graph, std::vector<Data>& held,
                  std::vector<std::string>& notes, Context& context);

/// The step whose result the i-th show shows.
const std::string& shown_step(const PipelineFile& file, size_t i);

struct DrawnPicture {
  Image image;
  Seen seen;
  TraceReport light;  ///< of pictures by paths, without planes
  std::string told;   ///< of volumes in measured steps: how exact they are
};

/// How a picture is drawn, beside what is stated.
struct DrawHow {
  double coarser = 1;                                          ///< as in RenderOptions
  std::optional<std::chrono::steady_clock::time_point> until;  ///< by paths: then it stops
  std::function<bool(DrawnPicture)> on_finer;                  ///< by paths: gets pictures on the way; false: no more of them
  double every = 1;                                            ///< as in LightWatch
  LightSoFar* so_far = nullptr;                                ///< as there; with on_finer
  bool layers = false;                                         ///< as in PictureOptions
  std::function<void(Frame&)> on_light;                        ///< as there
};

/// A scene, seen and annotated.
struct Panel {
  Scene scene;
  Camera camera;
  Annotation annotation;
  CameraDefaults around;           ///< what named views mean
  double margin = 0;               ///< share of the picture that views leave free at each side
  std::optional<Box3> box_behind;  ///< the last item of the scene is back_edges() of it
};
struct NamedPanel {
  std::string title;
  Panel panel;
};
/// Is the picture divided into panels?
bool in_panels(const PictureParams& p);
/// The panel of each show: one for each chain of steps from a file or a source on where inputs have panels, else 0 for all.
std::vector<size_t> panels_of(const PipelineFile& file, const PictureParams& p);
/// The name of the file, or of the first step, that a panel shows.
std::string panel_title(const PipelineFile& file, size_t panel);
/// Throws Error(usage).
NamedView view_named(const std::string& word);
/// What is stated for one panel of `count`: no title, and the size that it has beside those of `around`. Throws Error(usage) for a layout
/// that is none or has no place for all.
StatedPicture inside_layout(const StatedPicture& stated, const Annotation& around, size_t count);
/// The panels in rows, each with its title; title and legends of `around` beside them.
DrawnPicture draw_layout(const std::vector<NamedPanel>& panels, const StatedPicture& stated, const StatedPicture& inside,
                         const Annotation& around, const DrawHow& how, Context& context);

/// One entry under `show`, with its parameters.
struct StatedShow {
  const ShowKind* kind;
  ParamSet params;
};

/// "x0,x1,y0,y1,z0,z1", to a thousandth of the box along each axis, wherever it lies.
std::string box_words(const Box3& box);

/// Puts a filter at the end of the steps, under a name that is free; returns that.
std::string added_step(PipelineFile& file, const std::string& operation, std::vector<std::string> words, const std::string& from);
/// leave_out_sets() of picture_sets.h for all that is shown; `results` are those of the shows.
void leave_out_sets(PipelineFile& file, const std::vector<StatedShow>& shows, std::vector<Data>& results, std::vector<std::string>& notes,
                    Context& context);

/// The combined results of the shows of a panel.
struct Shown {
  Scene scene;
  std::vector<Legend> legends;  ///< each once
  Box3 box;
  bool outlined = false, any_points = false;
  bool patient = false;  ///< something of it is in the patient frame
  Vec3 stretch{1, 1, 1};
  std::string axis_titles[3], length_unit;
};

/// What each panel shows; `panel_of` tells the panel of each show. The legends of all are with the first one. Surfaces of datasets in
/// `copies` know what they are copies of.
std::vector<Shown> collect(const PipelineFile& file, const std::vector<StatedShow>& shows, const std::vector<Data>& results,
                           const std::vector<size_t>& panel_of, const PictureParams& stated, const Copies& copies, Context& context);

/// The edges of the box that do not lie in front of the data: those with a face turned away from the camera.
LinesItem back_edges(const Box3& box, const Camera& camera);
/// Where the picture itself lies, without its legends; whole pixels.
Rect picture_beside_legends(const Annotation& annotation, const StatedPicture& stated);
/// Renders beside the legends, continues the background behind them, and annotates.
DrawnPicture draw_picture(const Scene& scene, const Camera& camera, const StatedPicture& stated, const Annotation& annotation,
                          const DrawHow& how, Context& context);
/// Whether it is drawn by paths.
bool follows_light(const Scene& scene, const StatedPicture& stated);
/// Fills in picture.image, picture.seen, picture.stopped and picture.drafts, through options.on_draft where that is set.
void draw_drafts(const Scene& scene, const Camera& camera, const StatedPicture& stated, const Annotation& annotation,
                 const PictureOptions& options, Picture& picture, Context& context);

}  // namespace sg
