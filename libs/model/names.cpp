#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep
{

Names names_of(const Scene& scene)
{
    Names names;
    for (const Rock& rock : scene.rocks)
        names.rock.push_back(rock.name);
    for (const JointMaterial& material : scene.joint_materials)
        names.joint_material.push_back(material.name);
    for (const JointSet& set : scene.joint_sets)
        names.joint_set.push_back(set.name);
    for (const SingleJoint& joint : scene.joints)
        names.joint_set.push_back(joint.name);
    for (const MappedSet& mapped : scene.mapped)
        names.joint_set.push_back(mapped.name);
    for (const Stage& stage : scene.stages)
        names.stage.push_back(stage.name);
    return names;
}

} // namespace jointcreep
