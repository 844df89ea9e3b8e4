// SPDX-License-Identifier: Apache-2.0
#include "scene/show/other_names.h"

namespace sg {

namespace {

constexpr MissingName missing[] = {
    {"decimate decimatepro decimation quadricdecimation quadricclustering simplify decimatepolyline decimateboundary",
     "makes a surface of fewer triangles", "-f 'clean tolerance=...' (merges points up to that far apart)"},
    {"subdivide subdivision subdivideadaptive loopsubdivision linearsubdivision butterflysubdivision adaptivesubdivision subdividetetra "
     "refine",
     "divides straight cells into smaller ones", "-f tessellate (divides curved cells); -f resize (makes a grid finer)"},
    {"triangulate triangle triangles triangulation datasettriangle tetrahedralize triangulatecontours totriangles",
     "divides straight cells into triangles or tetrahedra",
     "-f tessellate (divides curved cells); pictures, .stl and .obj need no triangles"},
    {"delaunay delaunay2d delaunay3d alphashape convexhull triangulatepoints", "joins points to triangles or tetrahedra",
     "--show points (draws them)"},
    {"reconstructsurface surfacereconstruction extractsurfacefrompoints poisson poissonreconstruction ballpivoting",
     "lays a surface through points", "--show points (draws them)"},
    {"interpolate pointinterpolator pointdatasetinterpolator shepard shepardmethod gaussiansplat gaussiansplatter gaussianresampling "
     "kriging",
     "interpolates between points without cells", "-f 'probe with=...' (between the points of a mesh with cells)"},
    {"booleanunion union booleanadd", "joins closed surfaces without what lies inside",
     "-f 'clip with=... keep=outside', then -f 'append with=...'"},
    {"shrink shrinkpolydata", "shrinks each cell about its centre", "--show 'surface edges=true' (tells cells apart)"},
    {"explode explodedview explodedataset separatecells", "moves parts away from each other",
     "-f 'extract part=...', then -f 'transform translate=...'"},
    {"rotationalextrusion extruderotate revolve sweep", "turns a profile into a solid of revolution",
     "-f extrude (along a straight line); -f tubes (around lines)"},
    {"computeimplicitdistance implicitdistance distancepolydata signeddistance hausdorff hausdorffdistance", "gives distances to a surface",
     "-f distance_map (to samples of a grid); -f 'clip with=...' (what lies inside)"},
    {"geodesic geodesicdistance dijkstra", "finds shortest paths along a surface", ""},
    {"spline splinefit kochanekspline smoothlines", "lays smooth curves through points", "-f polylines (joins segments to lines)"},
    {"mediansmooth median imagemedian anisotropicdiffusion bilateral", "smooths a grid and keeps its edges",
     "-f gaussian_smooth (smooths edges too); -f morphology (of labels)"},
    {"fft rfft imagefft lowpass highpass", "transforms a grid to frequencies", "-f gaussian_smooth (removes high ones)"},
    {"padimage pad imagepad constantpad", "adds samples around a grid", "-f 'resample bounds=...'"},
    {"align icp iterativeclosestpoint landmarktransform alignxyz", "fits one mesh to another", "-f transform (moves as stated)"},
    {"projectpointstoplane flatten projecttoplane", "projects points to a plane", "-f 'slice axis=z' (cuts there)"},
    {"kmeans pca principalcomponents clustering multicorrelative contingency", "finds groups or correlations of values", "-f statistics"},
    {"temporalstatistics timeaverage temporalinterpolator temporalinterpolation", "averages or interpolates over time", ""},
};

}  // namespace

std::span<const MissingName> missing_names() { return missing; }

}  // namespace sg
