// SPDX-License-Identifier: Apache-2.0
// A denoiser: each pixel becomes a mean of those near it that look alike as far as noise can tell.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "render/trace/denoise/features.h"

namespace sg::trace {

/// Non-local means of which distances are in units of what noise explains (Buades, Coll, Morel 2005; Rousselle, Knaus, Zwicker 2012),
/// guided by features (Rousselle, Manzi, Zwicker 2013). Of a pixel p and its neighbours q, with colours u, features f and variances v of
/// both:
///
///   d(p, q) = ((u_p - u_q)^2 - v_p - min(v_p, v_q)) / (k^2 (v_p + v_q)),   mean over a patch and the colours;   the same of each feature
///   w(p, q) = min(exp(-d_u), exp(-d_f of the feature that differs most));   u_p becomes the mean of all u_q by w
///
/// `variance`: of the luminance of frame.rgba, which is linear and premultiplied. Where that is 0 all around, a pixel keeps its bytes. The
/// same bytes for any number of threads. Throws Error(usage) for lack of memory. O(pixels * neighbours).
void denoise(const Features& features, const Plane<float>& variance, Frame& frame, Context& context);

}  // namespace sg::trace
