// creepfit: find creep constants from what was measured.
//
//   creepfit curve.csv --stiffness 690 -o constants.csv                 of one joint, from one curve
//   creepfit joints.h5 --measurements readings.csv --fit kelvin-stiffness,joint-stiffness -o factors.csv
//                                                                       of all joints, through the solver
//   creepfit joints-*.h5 --measurements readings.csv --fit kelvin-stiffness -o factors.csv
//                                                                       the same, with the scatter of networks
//
// Reads   curve.csv, or joints.h5 (from strength-averaging) and readings.csv
// Writes  a table of what was found, and one of the readings on request   (docs/programs.md)
//
//         factors.failed.csv   if the search does not converge: the best factors so far
//
// One curve: creepfit_curve and libs/estimation. Through the solver: creepfit_section and libs/back_analysis.

#include "creepfit_curve.hpp"
#include "creepfit_errors.hpp"
#include "creepfit_files.hpp"
#include "creepfit_section.hpp"
#include "program.hpp"

using namespace jointcreep;

namespace
{

// Options of both kinds of fit, in the order of the help.
std::vector<Option> options()
{
    std::vector<Option> all{{"readings", "FILE.csv", "write measured and computed displacements, too"}};
    for (const auto& of_one_way :
         {creepfit::error_options(), creepfit::curve_options(), creepfit::section_options()})
        all.insert(all.end(), of_one_way.begin(), of_one_way.end());
    return all;
}

const Program program{
    .name = "creepfit",
    .summary = "Finds creep constants of joints from measured displacements.",
    .input = "CURVE.csv|joints.h5",
    .output = "FOUND.csv",
    .options = options(),
    .example = "creepfit joints.h5 --measurements readings.csv --fit kelvin-stiffness,kelvin-viscosity -o "
               "factors.csv",
    .columns =
        "  CURVE.csv       time_day, displacement_mm; optional: sigma_mm\n"
        "  --measurements  one row per reading: time_day, point, component (x or y), displacement_mm;\n"
        "                  optional: sigma_mm, event\n"
        "                  or one row per time, as jointexport writes it: time_day, event, and A_x_m, A_y_m,\n"
        "                  A_present of a point A; optional: A_x_sigma_m, A_y_sigma_m\n"
        "  A length may be in _m, _cm or _mm, as its name says.\n",
    .takes_several = true,
    .writes_text = true,
};

void fit(const Arguments& arguments)
{
    arguments.output(); // refuse early
    if (arguments.has("measurements")) {
        creepfit::refuse_options(arguments, creepfit::curve_options(), "a curve, not with --measurements");
        creepfit::fit_section(arguments);
    } else {
        creepfit::refuse_options(arguments, creepfit::section_options(), "joints.h5 and --measurements");
        creepfit::fit_curve(arguments);
    }
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, fit);
}
