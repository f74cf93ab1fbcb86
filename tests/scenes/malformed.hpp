#pragma once
/// \file
/// A scene that is right, and the ways in which it can be wrong.

#include <string>
#include <vector>

namespace taut::test {

/// A small scene that runs in a fraction of a second.
inline const std::string good_scene = R"([scene]
name = "small"
dimension = 2

[geometry]
type = "box"
min = [0.0, 0.0]
max = [0.2, 0.05]

[lattice]
dx = 0.0125

[material]
model = "st_venant_kirchhoff"
E = 2e6
nu = 0.3
density = 1000.0
plane = "stress"

[[boundary]]
type = "clamp"
on = "x_min"

[[boundary]]
type = "load"
on = "x_max"
force = 1000.0
direction = [1.0, 0.0]

[solve]
mode = "relax"
tolerance = 1e-4

[[probe]]
name = "tip_ux"
type = "displacement"
axis = "x"
at = [0.2, 0.025]

[[run]]
label = "total"
formulation = "tl_displacement"
operators = "corrected"
kernel = "wendland_c2"
support_dx = 1.5
)";

/// One mistake: what is replaced by what in the good scene, and what the message must then say.
struct Mistake {
  std::string name, what, by;
  unsigned line;  ///< that the message points at; 0: the mistake lies outside the scene file
  std::vector<std::string> says;
  bool loader_finds = true;  ///< false: only building the bodies shows it
};

inline std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// "[1, 2, …]".
inline std::string numbers(int count) {
  std::string all;
  for (int i = 1; i <= count; ++i) all += (i > 1 ? ", " : "[") + std::to_string(i);
  return all + ']';
}

inline const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all = {
      {"unknown_formulation",
       "\"tl_displacement\"",
       "\"tl_upwards\"",
       42,
       {"unknown name 'tl_upwards'", "tl_displacement", "ul_basic"}},
      {"unknown_kernel",
       "\"wendland_c2\"",
       "\"wendland\"",
       44,
       {"unknown name 'wendland'", "wendland_c2", "sinc5"}},
      {"unknown_operator",
       "\"corrected\"",
       "\"perfect\"",
       43,
       {"unknown name 'perfect'", "standard", "corrected"}},
      {"unknown_material",
       "\"st_venant_kirchhoff\"",
       "\"steel\"",
       14,
       {"unknown name 'steel'", "neo_hookean", "hypoelastic"}},
      {"unknown_integrator",
       "mode = \"relax\"\ntolerance = 1e-4",
       "mode = \"dynamic\"\nduration = 1.0\nintegrator = \"euler\"",
       33,
       {"unknown name 'euler'", "leapfrog"}},
      {"unknown_key",
       "nu = 0.3",
       "nu = 0.3\nyoung = 2e6",
       17,
       {"[material] has no key 'young'", "valid: model, E, nu"}},
      {"unknown_table", "[solve]", "[solver]\nx = 1\n[solve]", 30, {"has no key 'solver'", "solve"}},
      {"missing_key", "density = 1000.0\n", "", 13, {"[material] needs the key 'density'"}},
      {"missing_table", "[lattice]\ndx = 0.0125\n", "", 1, {"needs the key 'lattice'"}},
      {"missing_shape_key", "min = [0.0, 0.0]\n", "", 5, {"needs the key 'min'"}},
      {"wrong_type", "E = 2e6", "E = \"2 MPa\"", 15, {"must be a number, but is a string"}},
      {"wrong_vector", "at = [0.2, 0.025]", "at = [0.2]", 38, {"an array of 2 numbers"}},
      {"nu_too_large", "nu = 0.3", "nu = 0.5", 16, {"nu: is 0.5", "less than 0.5"}},
      {"negative_modulus", "E = 2e6", "E = -2e6", 15, {"E: is -2e+06", "greater than 0"}},
      {"infinite_density", "density = 1000.0", "density = inf", 17, {"must be finite"}},
      {"not_a_number", "E = 2e6", "E = nan", 15, {"must be finite"}},
      {"empty_body", "max = [0.2, 0.05]", "max = [0.2, 0.0]", 8, {"the body is empty"}},
      {"spacing_larger_than_body", "dx = 0.0125", "dx = 0.3", 10, {"0.3"}, false},
      {"negative_spacing", "dx = 0.0125", "dx = -0.0125", 11, {"dx: is -0.0125", "greater than 0"}},
      {"support_too_small",
       "support_dx = 1.5",
       "support_dx = 1.0",
       45,
       {"support_dx: is 1", "greater than 1"}},
      {"dimension_four", "dimension = 2", "dimension = 4", 3, {"is 4, but must be 1 … 3"}},
      {"bad_face",
       "on = \"x_max\"",
       "on = \"right\"",
       26,
       {"unknown name 'right'", "x_min, x_max, y_min, y_max"}},
      {"face_of_another_dimension", "on = \"x_max\"", "on = \"z_max\"", 26, {"unknown name 'z_max'"}},
      {"load_on_nothing", "on = \"x_max\"", "where = { x = [0.5, 0.6] }", 24, {"load", "no particle"}, false},
      {"selects_nothing", "on = \"x_max\"\n", "", 24, {"selects nothing", "x_min"}},
      {"syntax_error", "E = 2e6", "E = = 2e6", 15, {"not valid TOML"}},
      {"duplicate_key", "E = 2e6", "E = 2e6\nE = 3e6", 16, {"not valid TOML"}},
      {"no_runs",
       "[[run]]\nlabel = \"total\"\nformulation = \"tl_displacement\"\noperators = \"corrected\"\nkernel = "
       "\"wendland_c2\"\nsupport_dx = 1.5\n",
       "",
       1,
       {"needs the key 'run'"}},
      {"empty_run_list",
       "[[run]]\nlabel = \"total\"\nformulation = \"tl_displacement\"\noperators = \"corrected\"\nkernel = "
       "\"wendland_c2\"\nsupport_dx = 1.5\n",
       "[quick]\nruns = []\n",
       1,
       {"needs the key 'run'"}},
      {"unknown_run_in_quick",
       "support_dx = 1.5",
       "support_dx = 1.5\n[quick]\nruns = [\"totals\"]",
       47,
       {"no run is labelled 'totals'", "valid: total"}},
      {"view_of_a_flat_body",
       "support_dx = 1.5",
       "support_dx = 1.5\n[[picture]]\ntitle = \"t\"\nview = \"corner\"",
       48,
       {"[picture] view: needs dimension = 3"}},
      {"label_used_twice",
       "support_dx = 1.5",
       "support_dx = 1.5\n[[run]]\nlabel = \"total\"\nformulation = \"ul_basic\"",
       46,
       {"'total' is used twice"}},
      {"sweep_of_nothing", "[solve]", "[sweep]\nregion_density = [1.0]\n[solve]", 31, {"no [[region]]"}},
      {"measure_without_history",
       "at = [0.2, 0.025]",
       "at = [0.2, 0.025]\nmeasure = \"peak\"",
       34,
       {"needs a history"}},
      {"wrong_material_for_formulation",
       "\"tl_displacement\"\noperators = \"corrected\"",
       "\"ul_basic\"",
       40,
       {"hypoelastic"},
       false},
      {"key_of_another_formulation",
       "operators = \"corrected\"",
       "operators = \"corrected\"\nviscosity = 1.0",
       44,
       {"[run] viscosity: tl_displacement with corrected operators has no such key; it has: operators, "
        "kernel",
        "zero_energy_control"}},
      {"key_of_other_operators",
       "operators = \"corrected\"",
       "operators = \"corrected\"\ncompatible_iterations = 30",
       44,
       {"[run] compatible_iterations: tl_displacement with corrected operators has no such key"}},
      {"key_of_what_auto_did_not_choose",
       "\"tl_displacement\"\noperators = \"corrected\"\nkernel = \"wendland_c2\"\nsupport_dx = 1.5",
       "\"auto\"\nviscosity = 1.0",
       43,
       {"[run] viscosity: tl_stress_points has no such key; it has: zero_energy_control"}},
      {"not_whole",
       "\"tl_displacement\"\noperators = \"corrected\"",
       "\"tl_displacement\"\noperators = \"compatible\"\ncompatible_iterations = 2.5",
       44,
       {"[run] compatible_iterations: is 2.5, but must be a whole number from 0 to 1000000"}},
      {"probe_outside",
       "at = [0.2, 0.025]",
       "at = [-200.0, 25.0]",
       38,
       {"'tip_ux'", "outside of the body"},
       false},
      {"nothing_holds_the_body",
       "type = \"clamp\"\non = \"x_min\"",
       "type = \"roller\"\non = \"y_min\"",
       40,
       {"'total'", "free to move along x", "push it along x"},
       false},
      {"step_below_the_resolution_of_time",
       "mode = \"relax\"\ntolerance = 1e-4",
       "mode = \"dynamic\"\nduration = 1e-3\nmax_step = 1e-20",
       30,  // found before bodies are built, by its number of steps
       {"0.001 s would take about 1e+17 steps"},
       false},
      {"control_characters",
       "label = \"total\"",
       "label = \"\\u001b[31m\"",
       41,
       {"control character", "\\u001b"}},
      {"name_with_nul", "\"small\"", "\"a\\u0000b\"", 2, {"control character", "a\\u0000b"}},
      {"name_too_long", "\"small\"", '"' + std::string(250, 'a') + '"', 2, {"has 250 bytes", "200 at most"}},
      {"deep_key",
       "[solve]",
       "[sweep]\n" + repeated("a.", 30000) + "a = 1\n[solve]",
       31,
       {"a key of more than 17 parts"}},
      {"long_key", "dx = 0.0125", std::string(100000, 'k') + " = 1", 11, {"has no key 'kkk", "bytes"}},
      {"swept_twice", "[solve]", "[sweep]\nnu = [0.3, 0.1, 0.30]\n[solve]", 31, {"nu: lists 0.3 twice"}},
      {"too_many_cases",
       "[solve]",
       "[sweep]\nload = " + numbers(20000) + "\nregion_density = " + numbers(20000) + "\n[solve]",
       30,
       {"the most that a scene may have"}},
      {"labels_of_one_file",
       "support_dx = 1.5",
       "support_dx = 1.5\n[[run]]\nlabel = \"Total!\"\nformulation = \"tl_displacement\"",
       46,
       {"both be named 'small_total'", "bad.toml:40:"},
       false},
      {"missing_reference_file",
       "at = [0.2, 0.025]",
       "at = [0.2, 0.025]\nreference = { file = \"nowhere.csv\", column = \"ux\", keys = { nu = \"nu\" } "
       "}\n[sweep]\nnu = [0.3]",
       39,
       {"nowhere.csv", "cannot open"},
       false},
      {"missing_cloud",
       "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]\n\n[lattice]\ndx = 0.0125",
       "type = \"csv\"\nfile = \"nowhere.csv\"",
       5,
       {"nowhere.csv"},
       false},
  };
  return all;
}

/// The good scene with one mistake.
inline std::string with(const Mistake& mistake) {
  std::string text = good_scene;
  const std::size_t at = text.find(mistake.what);
  if (at == std::string::npos) return {};
  return text.replace(at, mistake.what.size(), mistake.by);
}

}  // namespace taut::test
