// SPDX-License-Identifier: Apache-2.0
// Rays through a lattice: emission and absorption with the sums of both tables over each step, and the other ray functions of
// src/scene/items/ray_function.h.
import { cameraChunk, lightChunk, scaleChunk } from "../draw/chunks";

export const modes = ["composite", "maximum", "minimum", "average", "sum", "first_hit", "distance", "accumulate", "isosurface", "maximum_difference"];

export const vertex = `
void main() {
  vec2 p = vec2((gl_VertexID & 1) == 1 ? 3.0 : -1.0, (gl_VertexID & 2) == 2 ? 3.0 : -1.0);
  gl_Position = vec4(p, 0.0, 1.0);
}`;

export interface Variant {
  mode: number;
  lit: boolean;
  gaps: boolean;
  nearest: boolean;
  cells: boolean;
  fast: boolean;
}

/** One program for each kind of volume: what software would compute for nothing is not there. */
export const fragment = (v: Variant) => `
#define MODE ${v.mode === 9 ? 0 : v.mode}
const bool uLit = ${v.lit}, uHasGaps = ${v.gaps}, uNearest = ${v.nearest}, uCells = ${v.cells}, uFast = ${v.fast};
uniform sampler3D uLattice, uDistance, uLeftOut;
uniform sampler2D uMedium, uSums, uFront, uBack;
uniform bool uHasFront;
uniform mat3 uToU;
uniform vec3 uOrigin, uLo, uHi, uDims, uSamplesAlong;
uniform float uStep, uEdge, uPerSurface, uLeast, uMost;
uniform int uLevelCount, uPlaneCount;
const int uMode = MODE;
uniform float uLevels[8];
uniform float uLevelOpacity[8];
uniform vec4 uPlanes[12];
${cameraChunk}${lightChunk}${scaleChunk}
uniform float uScaleLo, uScaleHi, uThreshold;
out vec4 oColor;

const int tableLast = 4095;
vec3 coordinate(vec3 u) { return (u + 0.5) / uSamplesAlong; }
float codeAt(vec3 u) {
  if (uNearest) return texelFetch(uLattice, ivec3(clamp(floor(coordinate(u) * uDims), vec3(0.0), uDims - 1.0)), 0).r;
  return textureLod(uLattice, coordinate(u), 0.0).r;
}
bool gone(vec3 u) {
  if (!uHasGaps) return false;
  vec3 v = coordinate(u) * uDims - 0.5;
  ivec3 cell = uCells ? ivec3(clamp(floor(v + 0.5), vec3(0.0), uDims - 1.0)) : ivec3(clamp(floor(v), vec3(0.0), uDims - 2.0));
  return texelFetch(uLeftOut, cell, 0).r > 0.5;
}
vec4 tableAt(sampler2D table, float code) {
  float x = clamp(code, 0.0, 1.0) * float(tableLast);
  int i = min(int(x), tableLast - 1), j = i + 1;
  return mix(texelFetch(table, ivec2(i & 1023, i >> 10), 0), texelFetch(table, ivec2(j & 1023, j >> 10), 0), x - float(i));
}
vec4 nearestOf(sampler2D table, float code) {
  int i = int(clamp(code, 0.0, 1.0) * float(tableLast) + 0.5);
  return texelFetch(table, ivec2(i & 1023, i >> 10), 0);
}
/* Central differences; in the outermost cells on to the slope that a parabola has at the border. */
float slopeAlong(int a, vec3 t, vec3 h) {
  vec3 e = vec3(0.0);
  e[a] = h[a];
  float v = t[a] * uDims[a] - 0.5, last = uDims[a] - 1.0;
  if (v >= 1.0 && v <= last - 1.0) return 0.5 * (textureLod(uLattice, t + e, 0.0).r - textureLod(uLattice, t - e, 0.0).r);
  if (last < 2.0) {
    t[a] = 0.5 * h[a];
    return textureLod(uLattice, t + e, 0.0).r - textureLod(uLattice, t, 0.0).r;
  }
  bool low = v < 1.0;
  t[a] = low ? 0.5 * h[a] : 1.0 - 0.5 * h[a];
  if (!low) e = -e;
  float f0 = textureLod(uLattice, t, 0.0).r, f1 = textureLod(uLattice, t + e, 0.0).r, f2 = textureLod(uLattice, t + 2.0 * e, 0.0).r;
  float inner = 0.5 * (f2 - f0), border = 2.0 * (f1 - f0) - inner;
  return (low ? 1.0 : -1.0) * mix(border, inner, clamp(low ? v : last - v, 0.0, 1.0));
}
/* Of codes per world length. */
vec3 gradientAt(vec3 u) {
  vec3 voxel = uSamplesAlong / uDims, t = coordinate(u), h = 1.0 / uDims;
  if (uFast) {  /* one-sided: half as many samples */
    vec3 f = vec3(textureLod(uLattice, t + vec3(h.x, 0, 0), 0.0).r, textureLod(uLattice, t + vec3(0, h.y, 0), 0.0).r, textureLod(uLattice, t + vec3(0, 0, h.z), 0.0).r);
    return (f - textureLod(uLattice, t, 0.0).r) / voxel * uToU;
  }
  vec3 g = vec3(slopeAlong(0, t, h), slopeAlong(1, t, h), slopeAlong(2, t, h)) / voxel;
  return g * uToU;
}
/* Light and gloss where the field has a gradient; a weak one is no surface. */
vec2 volumeLight(vec3 g, vec3 direction, bool surface) {
  float l = length(g);
  if (!(l > 0.0)) return vec2(1.0, 0.0);
  float weight = surface ? 1.0 : min(1.0, l * (uMost - uLeast) * uEdge * uPerSurface);
  vec3 n = g * ((dot(g, direction) > 0.0 ? -1.0 : 1.0) / l);
  vec2 light = lightOn(n, -direction);
  return vec2(1.0 + weight * (light.x - 1.0), weight * light.y);
}
float valueOf(float code) { return mix(uLeast, uMost, code); }
/* What scaleColor() takes. */
vec4 colorOfValue(float v) {
  if (uScaleKind == 0) return scaleColor((v - uScaleLo) / (uScaleHi - uScaleLo));
  return scaleColor(uScaleKind == 1 ? v / uScaleLo : v / uThreshold);
}

void main() {
  vec2 p = (gl_FragCoord.xy - 0.5 * uSize) / uScale;
  vec3 from = uEye, direction = uForward + uRight * p.x + uUp * p.y;
  if (uParallel) from += uRight * p.x + uUp * p.y, direction = uForward;
  float per = length(direction);
  direction /= per;
  vec3 o = uToU * (from - uOrigin), d = uToU * direction;
  float t0 = -1e30, t1 = 1e30;
  for (int a = 0; a < 3; ++a) {
    if (abs(d[a]) < 1e-30) { if (o[a] < uLo[a] || o[a] > uHi[a]) t1 = -1e30; continue; }
    float x = (uLo[a] - o[a]) / d[a], y = (uHi[a] - o[a]) / d[a];
    t0 = max(t0, min(x, y)), t1 = min(t1, max(x, y));
  }
  for (int i = 0; i < uPlaneCount; ++i) {
    float along = dot(uPlanes[i].xyz, direction), rest = uPlanes[i].w - dot(uPlanes[i].xyz, from);
    if (along > 0.0) t1 = min(t1, rest / along);
    else if (along < 0.0) t0 = max(t0, rest / along);
    else if (rest < 0.0) t1 = -1e30;
  }
  if (!uParallel) t0 = max(t0, 0.0);
  float enter = t0;
  ivec2 at = ivec2(gl_FragCoord.xy);
  float back = texelFetch(uBack, at, 0).r;
  if (back < 1.0) t1 = min(t1, fromDepth(back) * per);
  if (uHasFront) {
    float front = texelFetch(uFront, at, 0).r;
    if (front >= 1.0) discard;
    t0 = max(t0, front > 0.0 ? fromDepth(front) * per : t0);
  }
  if (!(t1 > t0)) discard;

  vec3 color = vec3(0.0);
  float pass = 1.0, h = uStep, best = 0.0, sum = 0.0, covered = 0.0, highest = 0.0;
  bool found = false, hit = false;
  ivec3 lastBrick = ivec3(-1);
  vec3 texel = uDims / uSamplesAlong;
  const bool skips = uMode == 0 || uMode == 5 || uMode == 8;
  float t = t0, code = codeAt(o + d * t);
#if MODE == 0
  vec2 light = vec2(1.0, 0.0);
  bool lit = false;
  vec4 sums = uFast || uNearest ? vec4(0.0) : tableAt(uSums, code);
#endif
  vec3 perTexel = 1.0 / max(abs(d * texel), vec3(1e-20));
  for (int i = 0; i < 8192; ++i) {
    if (!(t < t1)) break;
    vec3 u = o + d * t;
    if (skips) {
      vec3 v = coordinate(u) * uDims;
      ivec3 brick = ivec3(clamp(floor(v / 8.0), vec3(0.0), vec3(textureSize(uDistance, 0) - 1)));
      float far = brick == lastBrick ? 0.0 : floor(texelFetch(uDistance, brick, 0).r * 255.0 + 0.5);
      lastBrick = brick;
      if (far > 0.0) {
        lastBrick = ivec3(-1);
        vec3 lo = (vec3(brick) - (far - 1.0)) * 8.0, hi = (vec3(brick) + far) * 8.0;
        vec3 room = vec3(d.x > 0.0 ? hi.x - v.x : v.x - lo.x, d.y > 0.0 ? hi.y - v.y : v.y - lo.y, d.z > 0.0 ? hi.z - v.z : v.z - lo.z) * perTexel;
        t += max(min(room.x, min(room.y, room.z)), 0.0) + 1e-3 * h;
        code = codeAt(o + d * t);
#if MODE == 0
        if (!uFast && !uNearest) sums = tableAt(uSums, code);
#endif
        continue;
      }
    }
    float s = min(h, t1 - t);
    vec3 end = o + d * (t + s), middle = o + d * (t + 0.5 * s);
    float next = codeAt(end);
    bool skipped = gone(middle);
#if MODE == 0
    vec4 m, before = sums;
    float change = next - code;
    if (uNearest || uFast) m = nearestOf(uMedium, uNearest ? codeAt(middle) : 0.5 * (code + next)), m.rgb *= m.a;
    else {
      sums = tableAt(uSums, next);
      if (abs(change) > 0.004) m = (sums - before) / change;
      else m = nearestOf(uMedium, 0.5 * (code + next)), m.rgb *= m.a;
    }
    if (m.a > 0.0 && !skipped) {
      float alpha = 1.0 - exp(-m.a * s);
      /* Where little is seen, the light of the sample before will do. */
      if (uLit && (!lit || alpha * pass > (uFast ? 0.02 : 0.0004))) light = volumeLight(gradientAt(middle), direction, false), lit = true;
      color += pass * alpha * (m.rgb / m.a * light.x + light.y);
      pass *= 1.0 - alpha;
      if (pass < (uFast ? 0.02 : 0.002)) break;
    }
#else
    if (skipped) { t += s, code = next; continue; }
    if (uMode == 1 || uMode == 2) {
      float v = uNearest ? codeAt(middle) : uMode == 1 ? max(code, next) : min(code, next);
      if (!found || (uMode == 1 ? v > best : v < best)) best = v, found = true;
    } else if (uMode == 3 || uMode == 4) {
      sum += valueOf(0.5 * (code + next)) * s, covered += s, found = true;
    } else if (uMode == 7) {
      float a = valueOf(code) - uLevels[0], b = valueOf(next) - uLevels[0];
      found = true;
      covered += a >= 0.0 && b >= 0.0 ? s : a >= 0.0 ? s * a / (a - b) : b >= 0.0 ? s * b / (b - a) : 0.0;
    } else {
      /* Crossings of levels, in the order in which they lie. */
      float done = 0.0;
      for (int turn = 0; turn < 8; ++turn) {
        float first = 2.0;
        int which = -1;
        for (int k = 0; k < uLevelCount; ++k) {
          float level = (uLevels[k] - uLeast) / (uMost - uLeast);
          float x = (level - code) / (next - code);
          bool crosses = uMode == 8 ? (code < level) != (next < level) : code >= level || next >= level;
          if (uMode != 8 && code >= level) x = 0.0;
          if (crosses && x >= done && x < first) first = x, which = k;
        }
        if (which < 0) break;
        done = first + 1e-6;
        float low = first, tHit = t + s * low;
        if (uMode == 6) { covered = tHit - enter, found = true, hit = true; break; }
        vec3 place = o + d * tHit;
        vec4 c = colorOfValue(uMode == 8 ? uLevels[which] : valueOf(codeAt(place)));
        vec2 light = uLit ? volumeLight(gradientAt(place), direction, true) : vec2(1.0, 0.0);
        float alpha = uMode == 8 ? clamp(uLevelOpacity[which], 0.0, 1.0) : 1.0;
        color += pass * alpha * (c.rgb * light.x + light.y);
        pass *= 1.0 - alpha;
        if (uMode == 5 || pass < 0.002) { hit = true; break; }
      }
      if (hit) break;
    }
#endif
    t += s, code = next;
  }
#if MODE != 0
  if (found) {
    float v = uMode <= 2 ? valueOf(best) : uMode == 3 ? sum / covered : uMode == 4 ? sum : covered;
    if (uMode == 7 && !(covered > 0.0)) discard;
    bool drawn = uMode <= 2 ? nearestOf(uMedium, best).a > 0.0 : uMode == 3 ? nearestOf(uMedium, (v - uLeast) / (uMost - uLeast)).a > 0.0 : true;
    if (!drawn) discard;
    vec4 c = colorOfValue(v);
    if (!(c.a > 0.0)) discard;
    color = c.rgb, pass = 0.0;
  }
#endif
  if (!(pass < 1.0)) discard;
  oColor = vec4(color, 1.0 - pass);
}`;
