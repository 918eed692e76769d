"""What does not fit in a flight: picks, labels, clicks, landmarks, and errors of its inputs."""
