"""What the tests share: the command line as a function, films with known truth, tolerances."""
