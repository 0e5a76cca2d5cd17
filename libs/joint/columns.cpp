#include "joint/columns.hpp"

#include "joint/law.hpp"

namespace jointcreep::joint
{

namespace
{

using fields::Column, fields::component_column;

// The value of every `stride`th row, from `first` on.
Column column_of(std::string name, std::string units, const std::vector<double>& values,
                 std::size_t stride = 1, std::size_t first = 0)
{
    return {.name = std::move(name),
            .units = std::move(units),
            .value = [&values, stride, first](std::size_t row) { return values[row * stride + first]; }};
}

// Where joints have several Kelvin units, the unit's number is in the name, counted from 1.
std::vector<Column> edge_columns(const EquivalentJoints& joints)
{
    std::vector<Column> all;
    for (const Parameter& parameter : all_parameters())
        all.push_back(
            {.name = std::string(parameter.name),
             .units = parameter.si_unit(),
             .value = [&parameter, &joints](std::size_t edge) { return parameter.of(joints, edge); }});
    const std::size_t units = joints.kelvin_units();
    for (std::size_t unit = 0; unit < units; ++unit) {
        const std::string number = units == 1 ? "" : "_" + std::to_string(unit + 1);
        all.push_back(column_of("normal_kelvin_stiffness" + number, "Pa/m", joints.normal_kelvin_stiffness,
                                units, unit));
        all.push_back(
            column_of("shear_kelvin_stiffness" + number, "Pa/m", joints.shear_kelvin_stiffness, units, unit));
        all.push_back(column_of("normal_kelvin_viscosity" + number, "Pa s/m", joints.normal_kelvin_viscosity,
                                units, unit));
        all.push_back(column_of("shear_kelvin_viscosity" + number, "Pa s/m", joints.shear_kelvin_viscosity,
                                units, unit));
    }
    all.push_back(column_of("normal_maxwell_viscosity", "Pa s/m", joints.normal_maxwell_viscosity));
    all.push_back(column_of("shear_maxwell_viscosity", "Pa s/m", joints.shear_maxwell_viscosity));
    all.push_back({.name = "law",
                   .units = "1",
                   .value = [&joints](std::size_t edge) { return joints.law[edge]; },
                   .is_integer = true});
    return all;
}

std::vector<Column> contact_columns(const Result& result, std::size_t state)
{
    const States& states = result.states;
    const std::size_t first = state * result.mesh.contact_edge.size();
    const std::string traction = "/states/traction", relative = "/states/relative_displacement";
    return {
        component_column("normal_traction", "Pa", traction, states.traction, first, 0),
        component_column("shear_traction", "Pa", traction, states.traction, first, 1),
        component_column("normal_relative_displacement", "m", relative, states.relative_displacement, first,
                         0),
        component_column("shear_relative_displacement", "m", relative, states.relative_displacement, first,
                         1),
        {.name = "status",
         .units = "1",
         .value = [&states, first](std::size_t contact) { return states.contact_status[first + contact]; },
         .is_integer = true,
         .dataset = "/states/contact_status"}};
}

} // namespace

fields::ForceColumns columns_in_exports()
{
    return {.of_edges = edge_columns, .of_contacts = contact_columns};
}

} // namespace jointcreep::joint
