"""What people take away: attitude histories with uncertainty and flags, files, plots, a report."""
