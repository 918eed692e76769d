"""The methods of solution, one in each file; all work on stacks of problems."""
