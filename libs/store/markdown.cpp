#include "store/schema.hpp"

#include <sstream>

namespace jointcreep::store
{

using fields::Field;

namespace
{

std::string type_of(const Field& field)
{
    struct {
        std::string operator()(std::span<double>) const { return "float64"; }
        std::string operator()(std::span<Index>) const { return "int32"; }
        std::string operator()(std::span<std::string>) const { return "text"; }
    } const name;
    return std::visit(name, fields::flat(field.values));
}

// "[edge, 2]"
std::string shape_of(const Field& field)
{
    std::string text;
    for (const std::string& name : field.dimensions)
        text.append(text.empty() ? "[" : ", ").append(name);
    if (field.dimensions.empty())
        text = "[1";
    if (const std::size_t count = fields::components(field.values); count > 1)
        text.append(", ").append(std::to_string(count));
    return text.append("]");
}

std::string wanted_of(const Field& field)
{
    return type_of(field) == "text" ? "" : fields::wanted(field.limits);
}

void list(std::ostream& page, const std::string& title, const std::vector<Field>& fields,
          const std::vector<fields::Invariant>& invariants = {})
{
    page << "\n## " << title << "\n\n"
         << "| dataset | shape | type | unit | values | |\n"
         << "|---|---|---|---|---|---|\n";
    for (const Field& field : fields)
        page << "| `" << field.path << "` | " << shape_of(field) << " | " << type_of(field) << " | "
             << field.units << " | " << wanted_of(field) << " | " << field.description << " |\n";
    if (!invariants.empty())
        page << "\nIn addition, in every row:\n\n";
    for (const fields::Invariant& invariant : invariants)
        page << "- " << invariant.sentence << " (`" << invariant.path << "`).\n";
}

void list(std::ostream& page, const std::string& title, const std::vector<fields::Described>& rows)
{
    page << "| " << title << " | |\n|---|---|\n";
    for (const fields::Described& row : rows)
        page << "| `" << row.name << "` | " << row.description << " |\n";
}

} // namespace

std::string schema_markdown()
{
    Provenance provenance;
    Network network;
    EquivalentJoints equivalent;
    Result result;
    Safety safety;
    Checkpoint checkpoint;
    std::ostringstream page;
    page << R"(# File format

<!-- Made from libs/store/schema.cpp and libs/*/fields.cpp by: jointexport --file-format > docs/file-format.md -->

The programs exchange HDF5 files. A file has all data that later programs need:

| `filetype` | made by | contents |
|---|---|---|
| `jointcreep network` | jointgen | provenance, network |
| `jointcreep joints` | strength-averaging | the same, and equivalent joints |
| `jointcreep result` | demsolve | the same, and mesh, history, states, equilibria; the step history if asked for; dynamics of scenes with [large_displacements] |
| `jointcreep checkpoint` | demsolve | the same up to a time, and the state at this time |

This is format version )"
         << schema::major_version << "." << schema::minor_version << R"(.

- Every dataset has the attributes `units` and `description`. Everything is in SI units, angles in radians.
  Only times since the start are in days (but `/checkpoint/time` is in seconds). The unit `1` is that of plain numbers and of text.
- `DIMENSION_LABELS` names the axes, as HDF5's dimension scales do: `file["/history/displacement"].dims[0].label` is "time" in h5py. The
  parts of a row, such as {x, y}, are the axis "component". Files of format 2.6 and before have no labels.
- In `/history` the datasets `time`, `point` and `component` are dimension scales of the others. So `xarray.open_dataset()` finds names and
  coordinates of their axes. Files of format 2.7 and before have no scales; no program needs them.
- Tension, extension and opening are positive, angles run counter-clockwise, x points to the right and y up.
- An edge runs from its first vertex to its second; side b is on its left, side a on its right.
- Arrays are in C order: in [time, point, 2] the component runs fastest. A single value is an array of one element.
- Indices count from 0. An index of -1 means none. No number is ever NaN or infinite.
- Text is UTF-8 of fixed length, padded with zero bytes.
- Equal input gives equal bytes: a file contains no dates, paths or user names.
- Datasets have checksums. They are compressed, except where that saves very little. A damaged file is refused; a file that was changed on purpose can pass.
- An addition to the format raises the minor version. Any other change raises the major version: another name, meaning, unit or shape, or a removal.
- A program reads files of its own major version. It ignores datasets that it does not know, for example those that a higher minor version adds. It refuses a file that lacks a dataset that it needs, and names the dataset.
- A program refuses a file of another major version, and says which version it reads. It refuses a file that is not complete.
- While a file is written it is called `NAME.partial-` and a number; it is renamed when it is complete.

```python
import h5py

with h5py.File("result.h5") as file:
    time = file["/history/time"][:]                  # days
    points = file["/history/point"].asstr()[:]
    displacement = file["/history/displacement"][:]  # [time, point, {x, y}], metres
    scene = file["/scene"].asstr()[0]
    units = file["/history/displacement"].attrs["units"].decode()
```

## Attributes of the file

)";
    list(page, "attribute", schema::root_attributes());
    page << "\n## Dimensions\n\nArrays that share a dimension have the same number of rows along it; "
            "\"+1\" is one more.\n\n";
    list(page, "dimension", schema::dimensions());
    list(page, "Provenance", schema::fields_of(provenance));
    list(page, "Warnings", schema::fields_of(provenance.warnings));
    page << "\nThe group `/warnings` is there only if a program of the chain warned.\n";
    list(page, "Network", schema::fields_of(network), schema::invariants_of(network));
    list(page, "Equivalent joints", schema::fields_of(equivalent), schema::invariants_of(equivalent));
    page
        << "\nRows of other edges are 0: those that are no joint, and boundary edges without a joint under them.\n";
    std::vector<Field> of_result = schema::fields_of(result);
    std::vector<std::string> components;
    of_result.push_back(schema::component_of_history(components));
    list(page, "Result", of_result, schema::invariants_of(result.mesh));
    list(page, "Step history", schema::fields_of(result.step_history));
    page << "\nThe group `/step_history` is there only if a step history was asked for.\n";
    list(page, "Dynamics", schema::fields_of(result.dynamics));
    page << "\nThe group `/dynamics` is there only if the scene has [large_displacements] and a stage.\n";
    list(page, "Guards", schema::fields_of(result.guards));
    page
        << "\nThe group `/guards` is there if a state was recorded and checked; what is allowed is on the page "
           "[programs](programs.md).\n";
    list(page, "Failure", schema::fields_of(result.failure));
    page
        << "\nThe group `/failure` is there only in `NAME.failed.h5`, of a run that found no equilibrium, or that a signal "
           "stopped. All other data of such a file end with the last equilibrium.\n";
    list(page, "Factor of safety", schema::fields_of(safety));
    page << "\nThe group `/safety` is there only if a factor of safety was asked for.\n";
    list(page, "Checkpoint", schema::fields_of(checkpoint));
    page << "\nOnly in files of `--checkpoint`, from which a run can continue.\n";
    list(page, "State of a dynamic analysis", schema::fields_of(checkpoint.dynamics));
    page << "\nIn the same files, in scenes with [large_displacements].\n";
    return page.str();
}

} // namespace jointcreep::store
