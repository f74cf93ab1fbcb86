// Registries: names, parameters, and traits that say what is so.
#include <doctest/doctest.h>

#include <core/discretised.hpp>
#include <core/refusal.hpp>
#include <taut/extend.hpp>

using namespace taut;
using taut::test::refusal;

namespace {

struct Thing {
  std::string name;
  int number = 0;
};

bool says(const std::string& message, const std::string& part) {
  CAPTURE(message);
  CAPTURE(part);
  CHECK(message.find(part) != std::string::npos);
  return true;
}

const MaterialParameters rubber{.E = 1e6, .nu = 0.3, .density = 1000};

/// The method of a formulation, as `auto` would leave it.
Method method_of(const FormulationEntry& entry) { return with_defaults({.formulation = entry.name}); }
std::shared_ptr<const Material<2>> material_for(const FormulationEntry& entry) {
  for (const MaterialEntry& m : material_registry().entries())
    if (m.traits.kind == entry.traits.material && (m.traits.energy || m.traits.kind == MaterialKind::rate))
      return make_material<2>(m.name, rubber);
  return nullptr;
}
Cloud<2> cloud_of(double jitter) {
  return make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1, .jitter = jitter});
}

}  // namespace

TEST_CASE("a registry takes names once, and refuses with those it has") {
  Registry<Thing> things("thing", {{"one", 1}, {"two", 2}}, {"auto"});
  const Thing* one = &things.find("one");
  for (int k = 3; k < 100; ++k) things.add({"more_" + std::to_string(k), k});
  CHECK(one == &things.find("one"));  // entries stay where they are
  CHECK(things.find("more_42").number == 42);
  CHECK(things.look_up("none") == nullptr);
  CHECK(things.names()[1] == "two");
  CHECK(things.entries().size() == 99);
  says(refusal([&] { things.add({"one", 0}); }), "thing \"one\" is there already");
  says(refusal([&] { things.add({"auto", 0}); }), "thing \"auto\": the name means something else");
  for (const char* name : {"", "One", "1st", "a b", "a-b", "ü", "_a"})
    says(refusal([&] { things.add({name, 0}); }), "a name has small letters");
  says(refusal([&] {
         Registry<Thing>("thing", {{"b", 1}, {"a", 2}}).find("c");
       }),
       "unknown thing \"c\"; valid: b, a");
}

TEST_CASE("parameters are checked by their table, and completed from it") {
  const std::vector<Parameter> table = {
      number_parameter("alpha", 0.5, {0, 1, false, true}, "1/s", "a number"),
      whole_parameter("count", 3, 1, 9, "a whole number"),
      choice_parameter("mode", "slow", {"slow", "fast"}, "a choice"),
      required_number("given", Interval::any(), "m", "must be given")};
  ParameterMap given = {{"given", -2}, {"mode", "fast"}};
  complete_parameters(given, table, "it");
  CHECK(number_of(given, "alpha") == 0.5);
  CHECK(number_of(given, "count") == 3);
  CHECK(text_of(given, "mode") == "fast");
  CHECK(number_of(given, "given") == -2);
  const auto with = [&](ParameterMap map) {
    return refusal([&] {
      map.emplace("given", 0);
      complete_parameters(map, table, "it");
    });
  };
  CHECK(with({}).empty());
  says(with({{"beta", 1}}), "it has no parameter \"beta\"; it has: alpha, count, mode, given");
  says(with({{"alpha", 1.0}}), "alpha = 1 must not be negative, and less than 1");
  says(with({{"alpha", std::nan("")}}), "alpha = nan must not");
  says(with({{"alpha", "much"}}), "alpha = \"much\" must not");
  says(with({{"count", 2.5}}), "count = 2.5 must be a whole number from 1 to 9");
  says(with({{"mode", "warp"}}), "unknown mode \"warp\"; valid: slow, fast");
  says(with({{"mode", 1}}), "mode = 1 must be one of: slow, fast");
  ParameterMap nothing;
  says(refusal([&] { complete_parameters(nothing, table, "it"); }), "it needs the parameter \"given\"");
  says(refusal([&] { number_of(given, "mode"); }), "is a text, not a number");
  says(refusal([&] { number_of(given, "omega"); }), "no parameter \"omega\" is given");
}

TEST_CASE("defaults in tables are those of Method, and every member has its row") {
  std::vector<Parameter> all;
  for (const FormulationEntry& entry : formulation_registry().entries())
    for (const Parameter& p : entry.parameters) all.push_back(p);
  for (const OperatorEntry& entry : operator_registry().entries())
    for (const Parameter& p : entry.parameters) all.push_back(p);
  const Method open;
  for (const Parameter& p : all) {
    CAPTURE(p.name);
    CHECK(!p.line.empty());
    CHECK(is_member(p.name));
    CHECK_NOTHROW(p.check(p.fallback_value()));
    if (const auto value = given_parameter(open, p.name)) CHECK(*value == p.fallback_value());
    Method changed;
    set_parameter(changed, p.name, p.fallback_value());
    CHECK(given_parameter(changed, p.name) == p.fallback_value());
  }
  for (const FormulationEntry& entry : formulation_registry().entries()) {
    CAPTURE(entry.name);
    const Method m = with_defaults({.formulation = entry.name});
    if (const Parameter* support = find_parameter(entry.parameters, "support_dx"))
      CHECK(support->fallback_value() == ParameterValue(m.support_dx));
    const Parameter* control = find_parameter(entry.parameters, "zero_energy_control");
    CHECK((control ? *control->fallback_value().number() : 0) == entry.traits.zero_energy_control);
    CHECK((find_parameter(entry.parameters, "kernel") != nullptr) == entry.traits.pairs);
    CHECK((find_parameter(entry.parameters, "operators") != nullptr) == entry.traits.operators);
  }
  CHECK(with_defaults({.operators = "quadratic"}).support_dx == 2.4);
  CHECK(with_defaults({.formulation = "ul_basic", .operators = "standard"}).support_dx == 2.4);
}

TEST_CASE("a method's parameters: members by their names, others only where the formulation has them") {
  Method method{.formulation = "ul_basic",
                .parameters = {{"viscosity", 0.5}, {"velocity_gradient", "corrected"}}};
  const Method checked = checked_method(with_defaults(method));
  CHECK(checked.viscosity == 0.5);
  CHECK(checked.velocity_gradient == "corrected");
  CHECK(checked.parameters.empty());
  const auto message = [](Method m) { return refusal([&] { checked_method(with_defaults(std::move(m))); }); };
  says(message({.parameters = {{"damping", 1}}}),
       "formulation \"tl_displacement\" has no parameter \"damping\"; it has: operators, kernel, support_dx");
  says(message({.formulation = "tl_stress_points", .parameters = {{"damping", 1}}}),
       "it has: zero_energy_control");
  says(message({.formulation = "ul_basic", .parameters = {{"viscosity", -1}}}),
       "viscosity = -1 must not be negative");
  says(message({.formulation = "ul_basic", .parameters = {{"viscosity", "much"}}}), "viscosity = \"much\"");
  says(message({.operators = "compatible", .parameters = {{"compatible_iterations", 1.5}}}), "whole number");
  says(message({.formulation = "tl_bond_associated", .zero_energy_control = 1}),
       "zero_energy_control must be 0");
  says(message({.formulation = "ul_basic", .zero_energy_control = 1}), "zero_energy_control must be 0");
  CHECK(message({.formulation = "ul_basic", .zero_energy_control = 0}).empty());
}

TEST_CASE("traits of formulations say what they are") {
  for (const FormulationEntry& entry : formulation_registry().entries()) {
    CAPTURE(entry.name);
    CHECK(!entry.line.empty());
    CHECK(!entry.fails.empty());
    const FormulationTraits& traits = entry.traits;
    Cloud<2> cloud = cloud_of(0);
    Simulation<2> body(cloud, material_for(entry), method_of(entry));
    CHECK(body.method().support_dx == (traits.pairs ? traits.support_dx : body.method().support_dx));
    body.prepare();
    CHECK(refusal([&] { body.deformation_gradient(0); }).empty() == (traits.reference == Reference::total));
    CHECK(refusal([&] { body.strain_energy(); }).empty() == traits.energy);
    cloud.cells.clear();
    cloud.cell_share.clear();
    CHECK(refusal([&] { Simulation<2>(cloud, material_for(entry), method_of(entry)).prepare(); }).empty() ==
          !traits.cells);
    for (const MaterialEntry& m : material_registry().entries()) {
      CAPTURE(m.name);
      const std::string message = refusal(
          [&] { Simulation<2>(cloud_of(0), make_material<2>(m.name, rubber), method_of(entry)).prepare(); });
      CHECK(message.empty() == (m.traits.kind == traits.material));
      if (!message.empty()) says(message, join_names(material_names(traits.material)));
    }
  }
}

TEST_CASE("traits of operators say what they are") {
  for (const OperatorEntry& entry : operator_registry().entries()) {
    CAPTURE(entry.name);
    Method method = with_defaults({.operators = entry.name});
    CHECK(method.support_dx == entry.traits.support_dx);
    method.pair_precision = PairPrecision::double_precision;
    method.support_dx = 2.4;
    const Cloud<2> cloud = cloud_of(0.15);
    const Discretised<2> body(cloud, method);
    CHECK(body.op.adjoint_d.empty() == !entry.traits.adjoint);
    const auto worst = [&](auto&& f, auto&& slope) {
      double most = 0;
      for (Index a = 0; a < body.particles.n; ++a)
        most = std::max(most, (body.gradient(a, f) - slope(body.X(a))).norm());
      return most;
    };
    const double linear =
        worst([](const Vec<2>& X) { return X[0] - 2 * X[1]; }, [](const Vec<2>&) { return Vec<2>(1, -2); });
    const double quadratic = worst([](const Vec<2>& X) { return X[0] * X[1]; },
                                   [](const Vec<2>& X) { return Vec<2>(X[1], X[0]); });
    CHECK((linear < 1e-10) == (entry.traits.exact >= 1));
    CHECK((quadratic < 1e-8) == (entry.traits.exact >= 2));
    Cloud<2> bare = cloud;
    bare.B.clear();
    CHECK(refusal([&] { Discretised<2>(bare, method); }).empty() == !entry.traits.areas);
  }
}

TEST_CASE("traits of materials and kernels say what they are") {
  MaterialParameters sheet = rubber;
  sheet.plane = Plane::stress;
  for (const MaterialEntry& entry : material_registry().entries()) {
    CAPTURE(entry.name);
    CHECK(!entry.line.empty());
    const auto material = make_material<2>(entry.name, rubber);
    CHECK(kind_of(*material) == entry.traits.kind);
    const auto* law = dynamic_cast<const Hyperelastic<2>*>(material.get());
    CHECK((law && law->has_energy()) == entry.traits.energy);
    CHECK(refusal([&] { make_material<2>(entry.name, sheet); }).empty() == entry.traits.plane_stress);
    says(refusal([&] {
           MaterialParameters more = rubber;
           more.other = {{"yield", 1e5}};
           make_material<2>(entry.name, more);
         }),
         "it has no parameter \"yield\"; it has: none");
  }
  for (const KernelEntry& entry : kernel_registry().entries()) {
    CAPTURE(entry.name);
    CHECK(!entry.line.empty());
    const Kernel kernel(entry.name, 2);
    CHECK(kernel.radius_factor() == entry.radius_factor);
    CHECK((kernel.value(entry.radius_factor * (1 - 1e-12), 1) > 1e-9 * kernel.value(0, 1)) == entry.cut_off);
  }
  for (const SearchEntry& entry : search_registry().entries())
    CHECK(search_method(entry.name) == entry.method);
}

TEST_CASE("a kernel without a shape, a slope or an integral is refused") {
  const auto flat = [](double) { return 0.0; };
  says(refusal([&] { add_kernel({.name = "none", .line = "", .shape = nullptr, .slope = flat}); }),
       "needs a shape");
  says(refusal([&] { add_kernel({.name = "none", .line = "", .shape = flat, .slope = flat}); }),
       "no positive integral");
  says(refusal([&] {
         add_kernel({.name = "lucy", .line = "", .shape = [](double q) { return 2 - q; }, .slope = flat});
       }),
       "kernel \"lucy\" is there already");
}
