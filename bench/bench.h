// SPDX-License-Identifier: Apache-2.0
// The runner: every record is measured in a child process of its own, so that peak memory is per record.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace sg {
struct Camera;
}

namespace sg::bench {

/// One measurement. setup() runs once in the child, off the clock, and returns the work; work() returns a count that shows
/// that the work was done (triangles, points, pixels).
struct Task {
  std::string task, size;  ///< the names under which peers' records stand
  std::string peer;        ///< ours: "sightglass:..."
  std::string unit;        ///< of the count
  std::function<std::function<double()>()> setup;
};

/// A command timed from outside as a whole process.
struct ProcessTask {
  std::string task, size, peer;
  std::vector<std::string> command;
  std::string output;  ///< file it must write, or ""
  bool first = false;  ///< the time until that file is there, not until the process ends
};

/// `large`: with those that take 10 GB.
std::vector<Task> tasks(const std::string& data_folder, bool large);
/// That of the peers' scripts, turned by so many degrees about the vertical axis.
Camera peers_camera(double turn);
/// Families of tasks, a file each.
void add_contour_tasks(std::vector<Task>& tasks);
void add_cut_tasks(std::vector<Task>& tasks);
void add_index_tasks(std::vector<Task>& tasks);
void add_unsteady_tasks(std::vector<Task>& tasks);
void add_volume_tasks(std::vector<Task>& tasks);
void add_light_map_tasks(std::vector<Task>& tasks);
/// Errors, not times: VTK's pictures lie in the data folder (bench/vtk_volume_picture.py).
void add_volume_error_tasks(std::vector<Task>& tasks, const std::string& data_folder);
void add_volume_methods_tasks(std::vector<Task>& tasks);
void add_volume_cells_tasks(std::vector<Task>& tasks);
void add_flow_tasks(std::vector<Task>& tasks);
void add_walk_tasks(std::vector<Task>& tasks);
void add_particle_tasks(std::vector<Task>& tasks);
void add_glyph_tasks(std::vector<Task>& tasks);
void add_ftle_tasks(std::vector<Task>& tasks);
void add_lic_tasks(std::vector<Task>& tasks);
void add_lic2d_tasks(std::vector<Task>& tasks);
/// `large`: with those that take 10 GB.
void add_smoke_tasks(std::vector<Task>& tasks, bool large);
/// The path tracer beside Embree, by the peers' mesh_1M.raw in the data folder.
void add_trace_tasks(std::vector<Task>& tasks, const std::string& data_folder);
/// Pictures of a volume of size^3 f32 that stays on disk: with --only volume_large alone, for it takes 11 GB there at 1625^3.
void make_large_volume(const std::string& data_folder, const std::string& program, int size);
std::vector<ProcessTask> volume_large_tasks(const std::string& data_folder, const std::string& program, int size);
std::vector<ProcessTask> process_tasks(const std::string& data_folder, const std::string& program);

/// Writes the input files that are missing in the folder (formulas as in the peers' scripts).
void make_inputs(const std::string& data_folder);

}  // namespace sg::bench
