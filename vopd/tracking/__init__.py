"""Landmarks followed through a video, from a few clicks, with positions and lens known."""
