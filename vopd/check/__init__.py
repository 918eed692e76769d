"""A deck looked over before it is run: what is wrong, and what a careful person would question."""
