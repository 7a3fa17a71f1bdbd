"""Model of the time of an evaluation and of a step on the nodes of a cluster, for `scripts/validate scale`."""
