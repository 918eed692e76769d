"""The parts that only serve the report of Rae (1987): its sample, tables and listings."""
