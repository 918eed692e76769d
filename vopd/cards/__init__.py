"""Read and write card decks: convert columns of cards to jobs and back."""
