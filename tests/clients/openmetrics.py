"""Reads what /metrics says from standard input with both parsers of prometheus_client, the strict one of OpenMetrics and that of
the older text format, and prints the samples as JSON: a list of name, labels and value. Fails when one of the two does not take it, or
takes it otherwise than the other."""

import json
import sys

from prometheus_client.openmetrics.parser import text_string_to_metric_families as openmetrics
from prometheus_client.parser import text_string_to_metric_families as older


def samples(families):
    return [(sample.name, dict(sample.labels), float(sample.value)) for family in families for sample in family.samples]


text = sys.stdin.read()
read = samples(openmetrics(text))
assert sorted(map(repr, read)) == sorted(map(repr, samples(older(text)))), "the two parsers do not agree"
json.dump(read, sys.stdout)
