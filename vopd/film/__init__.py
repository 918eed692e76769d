"""Turn the results of a 1974 deck into the estimate that attitude works on."""
