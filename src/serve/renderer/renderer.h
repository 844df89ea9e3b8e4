// SPDX-License-Identifier: Apache-2.0
// What a session asks for pictures: something in this process or in another one. All that passes is a value that could be sent.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/context.h"
#include "base/text/json.h"
#include "pipeline/file/pipeline_file.h"
#include "serve/renderer/view_camera.h"

namespace sg::serve {

/// How good a picture is to be.
enum class Quality {
  moving,  ///< within the time that a drag leaves: fewer pixels, coarse samples, without numbers at the axes
  draft,   ///< all pixels, one coarse sample or path each
  exact,   ///< the picture that a file would hold
};

struct DrawRequest {
  int view = 0;
  int width = 1280, height = 720;    ///< pixels
  std::optional<ViewCamera> camera;  ///< none: chosen from the data
  Quality quality = Quality::exact;
  /// The window has legends and title around this part (x, y, width, height): while it moves, a picture of it is enough, if it is still
  /// where the camera looks.
  std::optional<std::array<int, 4>> part;
};

struct DrawnView {
  int width = 0, height = 0;  ///< of the encoded picture
  std::string type;           ///< "image/jpeg", "image/png"
  std::shared_ptr<const std::string> bytes;
  ViewCamera camera;          ///< that it was drawn from
  bool part = false;          ///< the picture is of `area` alone
  std::array<int, 4> area{};  ///< x, y, width, height of the part in which the camera looks; legends stand beside it
  double coarse = 1;          ///< pixels of the view that one of the picture stands for, along each side
  double seconds = 0;         ///< that it took
  std::string told;           ///< of pictures by paths and volumes in measured steps: how exact it is; "" for others
};

/// Gets pictures that are better than the last one and not yet what was asked for. Called by the thread that draws.
using OnFiner = std::function<void(const DrawnView&)>;

/// A pipeline, and what becomes of it. load() is called by one thread; forget() and pictures of what moves by another one meanwhile, of
/// what was loaded before; tell() and other pictures by either, never two of the same view at a time; answer() and save() by any number
/// of others. All stop with Error(cancelled) when the context is cancelled, and stay usable then and after any other error.
class Renderer {
 public:
  static constexpr int most_callers = 6;  ///< threads that ask one at the same time

  virtual ~Renderer() = default;
  /// Runs the pipeline and returns it with what was chosen from the data. What was loaded before stays where this throws.
  virtual PipelineFile load(const PipelineFile& pipeline, Context& context) = 0;
  /// Of what is loaded: members of the message "state" (docs/protocol.md).
  virtual Json::Members tell(Context& context) = 0;
  /// `on_finer` may be empty; pictures by paths come to it about every second.
  virtual DrawnView draw(const DrawRequest& request, const OnFiner& on_finer, Context& context) = 0;
  DrawnView draw(const DrawRequest& request, Context& context) { return draw(request, {}, context); }
  /// A view that will not be drawn again.
  virtual void forget(int view) = 0;
  /// Questions of docs/protocol.md: the members of the answer.
  virtual Json::Members answer(const Json& question, Context& context) = 0;
  /// The picture as a file, a PNG with its recipe. `name`: of the file, for its kind and for relative paths in the recipe; without a
  /// folder they are absolute. Throws Error(usage) for a kind that cannot be written or does not hold so large a picture.
  virtual std::string save(const DrawRequest& request, const std::string& name, Context& context) = 0;
};

}  // namespace sg::serve
