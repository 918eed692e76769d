"""Stars on the sky of a date and a place: catalogues, apparent places, local axes."""
