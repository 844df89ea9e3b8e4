// SPDX-License-Identifier: Apache-2.0
// Parts of shaders: the camera, the light model of src/render/shade/blinn_phong.h, colours of scales.

/** Eye space as in src/scene/camera.h: depth is positive in front. Pixels here count upwards. */
export const cameraChunk = `
uniform vec3 uEye, uRight, uUp, uForward;
uniform vec2 uSize;
uniform float uScale, uNear, uFar, uSamples;
uniform bool uParallel;
vec3 toEye(vec3 p) { vec3 d = p - uEye; return vec3(dot(d, uRight), dot(d, uUp), dot(d, uForward)); }
vec4 toClip(vec3 e) {
  vec2 half_ = 0.5 * uSize;
  if (uParallel) return vec4(e.xy * uScale / half_, (2.0 * e.z - uFar - uNear) / (uFar - uNear), 1.0);
  return vec4(e.xy * uScale / half_, ((uFar + uNear) * e.z - 2.0 * uFar * uNear) / (uFar - uNear), e.z);
}
float toDepth(float z) {
  float n = uParallel ? (z - uNear) / (uFar - uNear) : uFar * (z - uNear) / (z * (uFar - uNear));
  return clamp(n, 0.0, 1.0);
}
float fromDepth(float d) {
  return uParallel ? mix(uNear, uFar, d) : uFar * uNear / (uFar - d * (uFar - uNear));
}
vec3 toViewer(vec3 p) { return uParallel ? -uForward : normalize(uEye - p); }
`;

export const lightChunk = `
uniform int uLampCount;
uniform vec4 uLamps[8];
uniform vec4 uMaterial;
vec2 reflectedLight(vec3 n, vec3 view, float power) {
  vec2 sum = vec2(0.0);
  for (int i = 0; i < uLampCount; ++i) {
    float nl = dot(n, uLamps[i].xyz);
    if (!(nl > 0.0)) continue;
    float nh = (nl + dot(n, view)) / sqrt(max(2.0 + 2.0 * dot(uLamps[i].xyz, view), 1e-12));
    sum += uLamps[i].w * vec2(nl, pow(max(nh, 0.0), power));
  }
  return sum;
}
/* Light and gloss of a unit normal on the side that is seen. */
vec2 lightOn(vec3 n, vec3 view) {
  vec2 r = reflectedLight(n, view, uMaterial.w);
  return vec2(uMaterial.x + uMaterial.y * r.x, uMaterial.z * r.y);
}
`;

/** Colour of a value (see draw/scales.ts: linear: its position; log: over the low end; symlog: over the threshold). */
export const scaleChunk = `
uniform sampler2D uTable;
uniform int uTableSize, uScaleKind;
uniform vec4 uBelow, uAbove, uNan;
uniform vec2 uScaleEnds;
float scalePosition(float v) {
  if (uScaleKind == 0) return v;
  float y = uScaleKind == 1 ? log(max(v, 1e-37)) : (abs(v) <= 1.0 ? v : sign(v) * (1.0 + log(abs(v)) / 2.302585093));
  return (y - uScaleEnds.x) / (uScaleEnds.y - uScaleEnds.x);
}
vec4 scaleColor(float v) {
  if (!(abs(v) < 1e30)) return uNan;
  float t = scalePosition(v);
  if (t < -1e-5) return uBelow;
  if (t > 1.00001) return uAbove;
  int i = int(clamp(t, 0.0, 1.0) * float(uTableSize - 1) + 0.5);
  return texelFetch(uTable, ivec2(i & 1023, i >> 10), 0);
}
`;

/** How an item is coloured: 0 one colour, 1 by a value, 2 directly (sRGB, straight alpha). */
export const colorChunk = `
uniform int uColoring;
uniform vec4 uConstant;
uniform float uOpacity;
vec3 fromSrgb(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c)); }
`;

/** Layers of what is seen through: fragments in front of the last layer or behind what hides them are left out. */
export const peelChunk = `
uniform bool uPeeling;
uniform sampler2D uBefore, uHiding;
bool peeledAway(float depth) {
  if (!uPeeling) return false;
  ivec2 at = ivec2(gl_FragCoord.xy);
  return depth <= texelFetch(uBefore, at, 0).r + 1e-7 || depth >= texelFetch(uHiding, at, 0).r;
}
`;
