// SPDX-License-Identifier: Apache-2.0
// From a pipeline description to an annotated picture with its recipe inside.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "color/legend_content.h"
#include "image/image.h"
#include "pipeline/file/pipeline_file.h"
#include "render/trace/light_options.h"
#include "render/trace/progress/light_watch.h"

namespace sg {

/// Everything about a picture that is neither data nor camera.
struct PictureParams {
  std::string size = "1280x720";
  std::string background = "white";
  std::string title;
  bool legend = true, axes = true, triad = true, letters = true;
  std::optional<Vec3> stretch;
  std::vector<double> frame;  ///< of the data's coordinates: x0,x1,y0,y1,z0,z1
  std::string x_title, y_title, z_title;
  bool scale_bar = false;
  std::string caption, note;
  std::string measurements;  ///< of a window; not drawn
  std::string layout;
  std::vector<std::string> views;
  int samples = 0;
  double adaptive = 0;
  double text = 1;
  std::optional<trace::IntegratorKind> integrator;
  int seed = 0;
  LightOptions light;
  std::string lights, environment;
};
void describe(Schema& s, PictureParams& p);

/// "1280x720" to numbers; throws Error(usage).
void parse_size(const std::string& text, int& width, int& height);

/// The words a pipeline file may use under `show` and `picture`.
PipelineVocabulary picture_vocabulary();

struct Picture;
struct Panel;
struct StatedPicture;

/// One of several pictures: of a volume that memory does not hold, or by paths.
struct PictureDraft {
  std::string made_of;               ///< "level 3 of 7 (204x204x204)": what is in memory; or "bricks"
  double voxel_pixels = 1;           ///< largest number of pixels a voxel covers (if the allowed memory suffices)
  std::optional<TraceReport> light;  ///< of pictures by paths that grow, instead of these
  bool compared = false;
  double most = 0, mean = 0;  ///< of full scale: change from the picture with voxels of about twice that size, an estimate of the error
};

/// Under `show`, in the place of a way: it is chosen from the data. Takes the words of ColoringParams.
inline constexpr std::string_view auto_show = "auto";

struct PictureOptions {
  std::shared_ptr<Cache> cache;  ///< shared between pictures; null = one of its own
  /// For volumes that memory does not hold, and pictures by paths: gets a picture at once, then finer ones; only the final one is returned.
  /// Not called for others, nor for several panels.
  std::function<void(const Picture&, const PictureDraft&)> on_draft;
  std::optional<std::chrono::steady_clock::time_point> until;  ///< with on_draft: then the finest picture so far is returned
  bool layers = false;                                         ///< fill in all of Seen
  std::function<void(Frame&)> on_light;                        ///< gets what is drawn of each panel before it is shown, and may change it
  /// What is about to be drawn; false: it is not, and the picture has no pixels. Throws Error(usage) for a picture of several panels.
  std::function<bool(const Panel&, const StatedPicture&)> on_panel;
  std::function<void(std::string_view name, double seconds)> on_ran;  ///< see GraphOptions
  StepResults results;                                                ///< at hand, see build_graph()
  std::vector<std::string> coloring;  ///< words added to every way to show that colours by a field ("field=T", "map=ember")
};

/// What is seen where: planes of the whole picture, legends as background.
struct Seen {
  Plane<float> depth;    ///< along the view, in units of the data; of volumes where half of the light is gone; infinity where nothing is
  Plane<uint32_t> show;  ///< which entry under `show`, from 1; 0 where none is
  LightPlanes light;     ///< of pictures by paths; albedo and normal with PictureOptions::layers
  Plane<float> rgba;     ///< 4 a pixel, with PictureOptions::layers: the picture before texts, linear and premultiplied
};

struct Picture {
  Image image;
  Seen seen;
  std::vector<Legend> legends;       ///< each once, as drawn
  std::vector<std::string> notes;    ///< what was chosen and why, one line each
  std::vector<PictureDraft> drafts;  ///< with on_draft: of each that was made, this one last
  int stopped = 0;                   ///< by paths, where time ended it: as TraceReport::stopped
};

/// Evaluates the steps, shows what is requested (or else what the data suggests), renders and annotates.
/// `file` is completed with what was chosen, so that recipe_of() gives the recipe; where time ended a picture by paths, `stop` stands in
/// the place of `seconds`. All mistakes that can be seen beforehand are reported together, before anything runs.
Picture make_picture(PipelineFile& file, const PictureOptions& options, Context& context);

/// Puts the recipe, the version and the hashes of the inputs into the image's text. Paths of inputs are written relative to
/// the folder of `picture_path`, where the picture is going to be, or absolutely where `file` says so.
void attach_recipe(Image& image, const PipelineFile& file, const std::string& picture_path);
/// What a recipe may tell of it: series that a program lends (io/lent_series.h) are memory steps there.
PipelineFile without_lent(PipelineFile file);

/// The recipe inside a picture as stored, for inspection. Throws Error(data) when there is none.
PipelineFile recipe_in(const Image& image, const std::string& picture_path);
/// The recipe inside a picture, to be followed; its relative paths begin at the picture, and where it has absolute ones, so has a recipe of
/// what is returned (PipelineFile::absolute). Throws Error(data) when there is none, Error(usage) when it breaks check_recipe(). `changed`
/// receives the inputs whose content has changed.
PipelineFile recipe_in(const Image& image, const std::string& picture_path, std::vector<std::string>& changed);

/// A recipe is untrusted data, whoever made the picture: it may write no file (parameters in the unit "new file"), and read only below
/// the folder of the picture or the working folder (unit "file"). Throws one Error(usage) that names all steps and files in the way;
/// reading is allowed by allow_reading_anywhere(). See docs/security.md.
void check_recipe(const PipelineFile& recipe, const std::string& picture_path);

}  // namespace sg
