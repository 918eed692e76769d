"""The methods of solution: one method a file, each on stacks of problems."""
