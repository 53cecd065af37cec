"""Joints made softer or stiffer by a factor: their springs at once, and the parts that are shaped by them."""

from __future__ import annotations

from collections.abc import Mapping

from ..description.expand import instances
from ..joints import ElasticJoint
from ..machine import Machine
from ..reduction import SuperElement, TravellingElement

Factors = Mapping[str, float]
"""Factor on the stiffness as described, by the joint's entry in machine.yaml; 1 for those left out."""


def elastic_entries(machine: Machine) -> tuple[str, ...]:
    """The entries of machine.yaml's `joints` with some stiffness; wholly rigid joints have none to change."""
    configuration = machine.configuration()
    elastic = {
        joint.name
        for joint in machine.joints
        for spring in joint.springs(configuration.joint_values, configuration.placement)
        if spring.law.stiffness.any()
    }
    return tuple(entry for entry in machine.description.file.joints if elastic.intersection(_names(machine, entry)))


def scaled_joints(machine: Machine, factors: Factors) -> tuple[ElasticJoint, ...]:
    """The machine's joints with their stiffness, the drives' included, times the factors."""
    by_name = {name: factor for entry, factor in factors.items() for name in _names(machine, entry)}
    return tuple(joint.scaled(by_name.get(joint.name, 1.0)) for joint in machine.joints)


def parts_under(machine: Machine, factors: Factors) -> Mapping[str, SuperElement | TravellingElement]:
    """The machine's parts as it would load them with these factors: joint-loaded ones follow their joints."""
    described = {entry: machine.description.file.joints[entry].stiffness_factor or 1.0 for entry in factors}
    changes = {f"joints.{entry}.stiffness_factor": described[entry] * factor for entry, factor in factors.items()}
    return machine.replace(changes).parts


def _names(machine: Machine, entry: str) -> list[str]:
    """The joints that an entry stands for."""
    file = machine.description.file
    return [instance.name for instance in instances(entry, file.joints[entry].per, file.symmetry)]
