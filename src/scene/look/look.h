// SPDX-License-Identifier: Apache-2.0
// Good without options: looks at a dataset and chooses how to show it and from where.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/context.h"
#include "scene/camera_params.h"
#include "scene/choose/volume/head_pose.h"
#include "scene/show/show.h"

namespace sg {

struct Look {
  std::string source;                ///< operation that takes the file in place of what was read of it; empty = none
  std::vector<std::string> prepare;  ///< operation and its key=value words to run first; empty = none
  std::vector<std::string> filter;   ///< the same, after it
  struct Show {
    const ShowKind* kind;
    ParamSet params;                  ///< of the kind
    bool of_input = false;            ///< show the input, not the filter's result
    std::vector<std::string> filter;  ///< one of its own, of the input; empty = none
  };
  std::vector<Show> shows;
  CameraDefaults camera;
  std::vector<std::string> picture;  ///< words for it, where they are not stated
  std::optional<Box3> frame;         ///< the part in which something is seen; empty = all
  std::string reason;                ///< one line for the user: what was chosen and why
};

/// `field`: what the user wants to see; "" = the data decides. `extension`: of the file the data came from ("obj"); surfaces
/// made for graphics have y up. `of_series`: the data is a step of a file that is at hand, and one picture is to stand for all of it.
Look choose_look(const Dataset& data, const std::string& field, const std::string& extension, bool of_series = false);
/// A table whose rows follow one another in a column that increases, such as a distance or a time: the curve of `field`, or of the first
/// column that varies, over it. Nothing for other tables, such as those with words.
std::optional<Look> look_at_table(const Table& table, const std::string& field);
/// Turns the view of a CT scan of which nothing says how the patient lies, or of what was made of one, upright where a head is seen. What
/// was done, or can be, in words.
std::string face_unstated(const HeadPose& pose, CameraDefaults& camera);
/// Turns the view of surfaces that are coloured by nothing to have up along the axis on which they stand (scene/choose/view/upright.h),
/// where it is not the one that is customary in such files, nor stated by them. What is up, in words, where there is a doubt; "" else.
std::string stand_upright(std::span<const DatasetPtr> parts, const std::string& extension, CameraDefaults& camera);
/// A solid box whose outside hides a flow is shown by its streamlines.
void show_flow(Look& look, const DatasetPtr& data, const std::string& field, Context& context);
/// Connected pieces that have one value alone, beyond those of all pieces on which the field varies, such as a mould about what it forms,
/// take no colours from these: they are seen through.
void show_rigid(Look& look, std::span<const DatasetPtr> parts, const std::string& field, Context& context);
/// Turns the view of surfaces made for graphics, and of others and of few solid cells without a field, to the side that shows most of them.
void face_detail(Look& look, std::span<const DatasetPtr> parts, const std::string& extension, Context& context);
/// A solid whose outer surface tells nothing of what it is coloured by is cut open along the middle, with the half away from the viewer
/// kept.
void cut_open(Look& look, const DatasetPtr& data, const std::string& field, Context& context);

/// The view of flat data along its thin axis, of other data the usual one. `patient`: the data is in the patient frame; then slices are
/// seen as radiologists see them (axial from the feet, coronal from the front, sagittal from the left) and bodies from the front.
CameraDefaults choose_view(const Box3& bounds, const std::string& extension, bool patient);

}  // namespace sg
