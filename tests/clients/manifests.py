"""Holds Kubernetes objects in a file against Kubernetes' own schemas:   python3 manifests.py FILE

Fails with what is wrong. Every field must be known: the API server itself drops those that it does not know without a word."""

import sys

import kubernetes_validate
import yaml

# The oldest that is still repaired by its makers, and the newest of which the package knows.
VERSIONS = ["1.34", "1.37"]

with open(sys.argv[1], encoding="utf-8") as file:
    objects = list(yaml.safe_load_all(file))
for version in VERSIONS:
    for thing in objects:
        kubernetes_validate.validate(thing, version, strict=True)
        print(version, thing["kind"], thing["metadata"]["name"])
